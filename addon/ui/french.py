# SPDX-License-Identifier: GPL-3.0-or-later
"""The French interface: each text that is shown, and its translation.

Reports, and what refusals name, are English.
"""

from __future__ import annotations

from ...lib.settings.comparison import PASSES
from ...lib.settings.models import FRESNELS, MODELS, describe_models

FRENCH: dict[str, str] = {
    # The verdict.
    "Agrees with Cycles' render within {bound} everywhere": "Concorde avec le rendu de Cycles à {bound} près partout",
    "Agrees within {bound} so far; {tolerance} is not decided yet": "Concorde à {bound} près pour l'instant ; {tolerance} reste à décider",
    "Too few samples to say anything yet": "Trop peu d'échantillons pour conclure",
    "Differs by {difference} on '{name}'": "Diffère de {difference} sur « {name} »",
    "{light} differs by {difference} on '{name}'": "{light} diffère de {difference} sur « {name} »",
    "Differs by {difference} in the whole image": "Diffère de {difference} dans toute l'image",
    "{light} differs by {difference} in the whole image": "{light} diffère de {difference} dans toute l'image",
    "Differs by {difference} {place}, from pixel {pixel} on": "Diffère de {difference} ({place}), à partir du pixel {pixel}",
    "For a known reason: {causes}": "Pour une raison connue : {causes}",
    "{count} of {total} regions differ": "{count} régions sur {total} diffèrent",
    "{count} of {total} regions are too noisy to judge": "{count} régions sur {total} sont trop bruitées",
    "{total} regions tested, {confidence} confidence": "{total} régions testées, confiance de {confidence}",
    "About {time} should decide them": "{time} environ devraient suffire",
    "Cancelled; this is what was gathered": "Annulé ; voici ce qui a été obtenu",
    "{count} pixels are left out": "{count} pixels sont laissés de côté",
    "Light passes were not compared: about {cost} of Cycles' time": (
        "Passes de lumière non comparées : environ {cost} du temps de Cycles"
    ),
    "Light passes were not compared: not possible beside unsupported materials": (
        "Passes de lumière non comparées : impossible à côté de matériaux non pris en charge"
    ),
    "Light passes were not compared: too little memory": "Passes de lumière non comparées : trop peu de mémoire",
    "The scene has changed since; compare again": "La scène a changé depuis ; comparez à nouveau",
    # Regions.
    "whole image": "image entière",
    "material": "matériau",
    "angles of a material": "angles d'un matériau",
    "object": "objet",
    "cell": "cellule",
    "block": "bloc",
    "top left": "haut gauche",
    "top": "haut",
    "top right": "haut droite",
    "left": "gauche",
    "centre": "centre",
    "right": "droite",
    "bottom left": "bas gauche",
    "bottom": "bas",
    "bottom right": "bas droite",
    "red": "rouge",
    "green": "vert",
    "blue": "bleu",
    "unbounded": "sans borne",
    "{difference} in {channel}": "{difference} dans le {channel}",
    "{low} to {high}": "de {low} à {high}",
    "The difference is at most {bound}": "La différence est d'au plus {bound}",
    "'{name}' is no longer in the scene": "« {name} » n'est plus dans la scène",
    "Show Region": "Montrer la région",
    "Select this region's objects, set the render region to it, zoom Image editors to it": (
        "Sélectionner les objets de cette région, y placer la région de rendu et y agrandir les éditeurs d'images"
    ),
    "Whole Frame": "Cadre entier",
    "Render the whole frame again": "Rendre à nouveau le cadre entier",
    # While it runs.
    "reading the scene": "lecture de la scène",
    "timing the renderers": "chronométrage des moteurs",
    "looking for caustics": "recherche de caustiques",
    "first look": "premier examen",
    "rendering": "rendu",
    "rendering what is open": "rendu de ce qui reste ouvert",
    "writing the report": "écriture du rapport",
    "looking for the smallest scene that shows it": "recherche de la plus petite scène qui le montre",
    "rendering each setting": "rendu de chaque réglage",
    "measuring": "mesure",
    "Ending": "Arrêt en cours",
    "No bound yet": "Pas encore de borne",
    "Within {bound}": "À {bound} près",
    "Within {bound}, falling": "À {bound} près, en baisse",
    "{time} left": "encore {time}",
    "Esc cancels": "Échap annule",
    "Another scene is being compared": "Une autre scène est en cours de comparaison",
    "Étalon: cancelled before there was a result": "Étalon : annulé avant tout résultat",
    "Étalon: {verdict}": "Étalon : {verdict}",
    "Étalon: done": "Étalon : terminé",
    # Before the button is pressed.
    "There is no camera: add one and make it active": "Il n'y a pas de caméra : ajoutez-en une et rendez-la active",
    "Another engine is chosen; Cycles' render is compared": "Un autre moteur est choisi ; c'est le rendu de Cycles qui est comparé",
    "Cycles is set to GPU; it is compared on the CPU": "Cycles est réglé sur GPU ; il est comparé sur CPU",
    "Motion blur is off in this scene or its view layer, so it is not compared": (
        "Le flou de mouvement est désactivé dans cette scène ou son calque de vue ; il n'est pas comparé"
    ),
    "The file is not saved; results go to {folder}": "Le fichier n'est pas enregistré ; les résultats iront dans {folder}",
    "'{name}': {what} is not simulated": "« {name} » : Étalon ne simule pas {what}",
    "and {count} more": "et {count} autres",
    "{width} × {height} pixels, at most {time}": "{width} × {height} pixels, {time} au plus",
    # Errors; most of their texts are in french_errors.py and french_refusals.py.
    "{owner}: {what} is not simulated; {remedy}": "{owner} : Étalon ne simule pas {what} ; {remedy}",
    "{kind} '{name}'": "{kind} « {name} »",
    "node '{name}' ({label})": "le nœud « {name} » ({label})",
    "group '{group}', {node}": "{node} du groupe « {group} »",
    "light": "lumière",
    "world": "monde",
    "scene": "scène",
    "collection": "collection",
    "mesh": "maillage",
    "view layer": "calque de vue",
    "the scene": "la scène",
    "the file": "le fichier",
    "the camera": "la caméra",
    "the second Blender": "le second Blender",
    # Buttons.
    "Compare with Cycles": "Comparer à Cycles",
    "Render this scene with the reference and Cycles, and say where they agree. Esc cancels": (
        "Rendre cette scène avec la référence et avec Cycles, et dire où les deux concordent. Échap annule"
    ),
    "Compare the Rest": "Comparer le reste",
    "Compare without motion blur and without the pixels that show unsupported materials": (
        "Comparer sans flou de mouvement et sans les pixels qui montrent des matériaux non pris en charge"
    ),
    "Select What Is Not Supported": "Sélectionner ce qui n'est pas pris en charge",
    "Select what is not supported: the object, or the objects with the material": (
        "Sélectionner ce qui n'est pas pris en charge : l'objet, ou les objets qui ont le matériau"
    ),
    "Cancel (Esc)": "Annuler (Échap)",
    "End the comparison; what both renderers finished is judged and kept": (
        "Terminer la comparaison ; ce que les deux moteurs ont fini est jugé et gardé"
    ),
    "Open Report": "Ouvrir le rapport",
    "Open the report in the web browser": "Ouvrir le rapport dans le navigateur",
    "Open the page with all figures in the web browser": "Ouvrir la page de tous les chiffres dans le navigateur",
    "{path} is not there any more": "{path} n'existe plus",
    # Target, model, region, passes.
    "Target": "Objectif",
    "Apply Target": "Appliquer l'objectif",
    "Set tolerance, time and image size to those of this target": "Prendre la tolérance, la durée et la taille de cet objectif",
    "Quick look": "Coup d'œil",
    "Review": "Examen",
    "Proof": "Preuve",
    "Tolerance": "Tolérance",
    "Largest relative difference that counts as agreement": "Plus grande différence relative qui compte comme un accord",
    "Confidence": "Confiance",
    "Confidence of the whole verdict, all regions together": "Confiance du verdict entier, toutes régions ensemble",
    "Time": "Durée",
    "Time budget; a comparison ends sooner if every region is decided sooner": (
        "Durée allouée ; une comparaison finit plus tôt si chaque région est décidée plus tôt"
    ),
    "Image size": "Taille de l'image",
    "Auto: compare a smaller image of the same view where the whole one gives no useful answer in time; full: never": (
        "Auto : comparer une image plus petite de la même vue si l'image entière ne donne rien d'utile à temps ; entière : jamais"
    ),
    "Auto": "Auto",
    "Full": "Entière",
    "Partial": "Partiel",
    "Compare what can be compared: leave out pixels that show unsupported materials, and leave room for their light in the others": (
        "Comparer ce qui peut l'être : laisser de côté les pixels montrant des matériaux non pris en charge, et place à leur lumière ailleurs"
    ),
    "Motion blur": "Flou de mouvement",
    "Compare with the scene's motion blur: objects, the camera and meshes that deform; otherwise it is off on both sides": (
        "Comparer avec le flou de mouvement de la scène : objets, caméra et maillages déformés ; sinon désactivé des deux côtés"
    ),
    "Output": "Sortie",
    "Folder for the report, verdict.json and images; // is the folder of this file": (
        "Dossier pour le rapport, verdict.json et les images ; // est le dossier de ce fichier"
    ),
    "Model": "Modèle",
    "Strategy": "Stratégie",
    "Sampling of glossy lobes: visible, bounded, d_cos, cosine, uniform": (
        "Échantillonnage des lobes brillants : visible, borné, D cos, cosinus, uniforme"
    ),
    "Visible": "Visible",
    "Bounded": "Borné",
    "D cos": "D cos",
    "Cosine": "Cosinus",
    "Uniform": "Uniforme",
    "Lobes": "Lobes",
    f"Model in place of the lobes of Glossy nodes: {describe_models(MODELS)}; empty: each node's own": (
        f"Modèle à la place des lobes des nœuds Glossy : {describe_models(MODELS)} ; vide : celui de chaque nœud"
    ),
    "Fresnel": "Fresnel",
    f"Fresnel term of the lobes of Glossy nodes: {describe_models(FRESNELS)}": (
        f"Terme de Fresnel des lobes des nœuds Glossy : {describe_models(FRESNELS)}"
    ),
    "Direct light": "Lumière directe",
    "Sampling of direct light: mis, lights, bsdf": "Échantillonnage de la lumière directe : multiple, lampes, BSDF",
    "Mis": "Multiple",
    "Lights": "Lampes",
    "Bsdf": "BSDF",
    "Masking": "Masquage",
    "Masking-shadowing: correlated, separable, torrance_sparrow": "Masquage-ombrage : corrélé, séparable, Torrance-Sparrow",
    "Correlated": "Corrélé",
    "Separable": "Séparable",
    "Torrance sparrow": "Torrance-Sparrow",
    "Random numbers": "Nombres aléatoires",
    "Random numbers: sobol, random": "Nombres aléatoires : Sobol, aléatoires",
    "Random": "Aléatoires",
    "Region": "Région",
    "Frame": "Image",
    "Resolution": "Résolution",
    "Passes": "Passes",
    "Light passes": "Passes de lumière",
    "Light": "Lumière",
    "All of the light": "Toute la lumière",
    "Show Light": "Afficher une lumière",
    "Show this part of the light in the images of the comparison, and its regions in the list": (
        "Montrer cette partie de la lumière dans les images de la comparaison, et ses régions dans la liste"
    ),
    "The parts of the light that were compared": "Les parties de la lumière qui ont été comparées",
    (
        "Light passes to compare beside the image, which say in which light it differs; auto: all, where they cost Cycles less than "
        f"10 % of its time: {', '.join(PASSES)}"
    ): (
        "Passes de lumière à comparer avec l'image, qui disent dans quelle lumière elle diffère ; auto : toutes, là où elles coûtent à "
        f"Cycles moins de 10 % de son temps : {', '.join(PASSES)}"
    ),
    "None": "Aucune",
    "All": "Toutes",
    "Diffuse": "Diffuse",
    "Glossy": "Brillante",
    "Transmission": "Transmission",
    "Volume": "Volume",
    "Emission": "Émission",
    "Environment": "Environnement",
    "Diffuse direct": "Diffus direct",
    "Diffuse indirect": "Diffus indirect",
    "Glossy direct": "Brillant direct",
    "Glossy indirect": "Brillant indirect",
    "Volume direct": "Volume direct",
    "Volume indirect": "Volume indirect",
    "Transmission direct": "Transmission directe",
    "Transmission indirect": "Transmission indirecte",
    "Compare the light of each lamp, each emitting object and the world, which says whose light differs": (
        "Comparer la lumière de chaque lampe, de chaque objet émetteur et du monde, ce qui dit laquelle diffère"
    ),
    # Settings, cost and plan.
    "Settings, Cost and Plan": "Réglages, coût et plan",
    "Audit My Settings": "Auditer mes réglages",
    "Measure what each Cycles setting of this scene costs in bias, noise and time": (
        "Mesurer ce que chaque réglage de Cycles coûte dans cette scène en biais, en bruit et en temps"
    ),
    "biased": "biaisé",
    "no bias": "sans biais",
    "undecided": "indécis",
    "Every setting is at its neutral value": "Chaque réglage a sa valeur neutre",
    "Apply": "Appliquer",
    "Set this setting of the scene to its neutral value": "Donner à ce réglage de la scène sa valeur neutre",
    "{setting} is set to {value}": "{setting} vaut maintenant {value}",
    "What Does Accuracy Cost?": "Que coûte la précision ?",
    "Measure the error of every way to render this scene against the time it takes": (
        "Mesurer l'erreur de chaque façon de rendre cette scène en fonction du temps"
    ),
    "Plan": "Plan",
    "List the effects that this scene needs and why, and everything that is not simulated": (
        "Énumérer les effets dont cette scène a besoin, chacun avec sa raison, et tout ce qui n'est pas simulé"
    ),
    "Not everything is simulated; see above": "Tout n'est pas simulé ; voir plus haut",
    # Images.
    "Show Image": "Montrer une image",
    "Show an image of the last comparison in an Image editor": "Montrer une image de la dernière comparaison dans un éditeur d'images",
    "Switch Image": "Changer d'image",
    "Show another image of the comparison": "Montrer une autre image de la comparaison",
    "The images of the last comparison": "Les images de la dernière comparaison",
    "Image": "Image",
    "Reference": "Référence",
    "Cycles": "Cycles",
    "Difference": "Différence",
    "Significance": "Significativité",
    "Verdict": "Verdict",
    "The reference's image": "L'image de la référence",
    "Cycles' image": "L'image de Cycles",
    "Red where Cycles is brighter, blue where it is darker; full colour (1) at five times the tolerance": (
        "Rouge où Cycles est plus clair, bleu où il est plus sombre ; pleine couleur (1) à cinq fois la tolérance"
    ),
    "The difference in standard errors: red above, blue below; full colour (1) at five": (
        "La différence en erreurs types : rouge au-dessus, bleu au-dessous ; pleine couleur (1) à cinq"
    ),
    "Green agrees, red differs, yellow is undecided, blue differs for a known reason": (
        "Vert : concorde, rouge : diffère, jaune : indécis, bleu : diffère pour une raison connue"
    ),
    # Reference scenes and preferences.
    "Reference Scene": "Scène de référence",
    "Open a scene whose image is known. It replaces this file, which can be saved first": (
        "Ouvrir une scène dont l'image est connue ; elle remplace ce fichier, qui peut être enregistré d'abord"
    ),
    "Scenes whose images are known": "Scènes dont l'image est connue",
    "Scene": "Scène",
    "Glossy spheres": "Sphères brillantes",
    "Sigma sweep": "Balayage de sigma",
    "Furnace": "Four",
    "Grazing plane": "Plan rasant",
    "Veach plates": "Plaques de Veach",
    "Cornell glossy": "Cornell brillant",
    "Lambert analytic": "Lambert analytique",
    "Far from origin": "Loin de l'origine",
    "Threads": "Fils d'exécution",
    "Threads of both renderers; 0: all processors but one": "Fils d'exécution des deux moteurs ; 0 : tous les processeurs sauf un",
    "Results": "Résultats",
    "Folder for results where a scene does not name one; empty: beside the file": (
        "Dossier pour les résultats si une scène n'en nomme pas ; vide : à côté du fichier"
    ),
    "Keep EXRs": "Garder les EXR",
    "Leave float images beside the report: reference.exr, cycles.exr and difference.exr": (
        "Laisser des images à virgule flottante à côté du rapport : reference.exr, cycles.exr et difference.exr"
    ),
    "Blender to use": "Blender à utiliser",
    "Another Blender program that renders Cycles' side; empty: this one": (
        "Un autre programme Blender qui rend le côté de Cycles ; vide : celui-ci"
    ),
}
