# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors in French: the templates by which they are recognised, and how each reads."""

from __future__ import annotations

ERRORS: dict[str, str] = {
    # Files and folders.
    "{path}: cannot be written ({reason}); make room or name another folder": (
        "{path} : écriture impossible ({reason}) ; faites de la place ou choisissez un autre dossier"
    ),
    "{path}: cannot be written (it does not read back as written); make room or name another folder": (
        "{path} : écriture impossible (relu, il est différent) ; faites de la place ou choisissez un autre dossier"
    ),
    "{place} cannot be written ({reason}); make room or name another folder": (
        "Impossible d'écrire {place} ({reason}) ; faites de la place ou choisissez un autre dossier"
    ),
    "{folder} cannot be written ({reason}); name another folder": (
        "Impossible d'écrire dans {folder} ({reason}) ; choisissez un autre dossier"
    ),
    "{folder} is a file, not a folder; name another folder": (
        "{folder} est un fichier, pas un dossier ; choisissez un autre dossier"
    ),
    "{path}: cannot be read ({reason}); write it again": (
        "{path} : lecture impossible ({reason}) ; écrivez-le à nouveau"
    ),
    "{path}: cannot be read ({reason}); check the path": (
        "{path} : lecture impossible ({reason}) ; vérifiez le chemin"
    ),
    "{path}: is damaged or no scene of Étalon's ({reason}); export the scene again": (
        "{path} : endommagé, ou pas une scène d'Étalon ({reason}) ; exportez la scène à nouveau"
    ),
    "{path}: is of version {version}, not {known}; export the scene again": (
        "{path} : de la version {version} au lieu de {known} ; exportez la scène à nouveau"
    ),
    "Cycles' image cannot be read back from {folder}; make room there, or set TMPDIR to another folder": (
        "L'image de Cycles ne peut être relue dans {folder} ; faites-y de la place, ou donnez un autre dossier à TMPDIR"
    ),
    # Blender.
    "{title} ended early ({words}); compare from the command line to see more": (
        "{title} s'est arrêté trop tôt ({words}) ; comparez en ligne de commande pour en savoir plus"
    ),
    "etalon {command}: the second Blender ended early": ("etalon {command} : le second Blender s'est arrêté trop tôt"),
    "{name}: was saved by Blender {needed}, and this is {here}, which loses what is new in it; open it with Blender "
    "{newer} or newer": (
        "{name} : enregistré par Blender {needed}, dont {here} perd les nouveautés ; ouvrez-le avec Blender {newer} ou "
        "plus récent"
    ),
    "Blender {here} is too old; Étalon needs Blender {oldest} or newer": (
        "Blender {here} est trop ancien ; il faut à Étalon Blender {oldest} ou plus récent"
    ),
    "Cycles is not there; enable the add-on Cycles Render Engine in Blender's preferences": (
        "Cycles n'est pas là ; activez l'extension Cycles Render Engine dans les préférences de Blender"
    ),
    "this Blender was built without Open Image Denoise; use one from blender.org": (
        "ce Blender est compilé sans Open Image Denoise ; prenez-en un de blender.org"
    ),
    "{scene}: Blender cannot render it ({reason}); mend that in Blender": (
        "{scene} : Blender ne peut pas la rendre ({reason}) ; réparez cela dans Blender"
    ),
    "{scene}: Cycles cannot render it ({reason}); try F12 in Blender": (
        "{scene} : Cycles ne peut pas la rendre ({reason}) ; essayez F12 dans Blender"
    ),
    "{name} is animated or driven, and must stay at {value}; mute its channel": (
        "{name} est animé ou piloté, et doit rester à {value} ; rendez muet son canal"
    ),
    "view transform '{name}' cannot be applied (its process ended early)": (
        "la transformation d'affichage « {name} » est inapplicable (son processus s'est arrêté trop tôt)"
    ),
    "view transform '{name}' cannot be applied ({reason})": (
        "la transformation d'affichage « {name} » est inapplicable ({reason})"
    ),
    "colour space '{name}' cannot be converted ({reason})": (
        "l'espace colorimétrique « {name} » ne peut être converti ({reason})"
    ),
    # The scene.
    "{scene}: the scene has no camera; add one and make it the active camera": (
        "{scene} : la scène n'a pas de caméra ; ajoutez-en une et rendez-la active"
    ),
    "{name}: the scene looks through an object that is no camera; choose a camera object": (
        "{name} : la scène est vue par un objet qui n'est pas une caméra ; choisissez une caméra"
    ),
    "{scene}: no view layer is used for rendering; switch one on": (
        "{scene} : aucun calque de vue ne sert au rendu ; activez-en un"
    ),
    "{scene}: the scene has no faces to render; add an object with a surface": (
        "{scene} : la scène n'a pas de faces à rendre ; ajoutez un objet avec une surface"
    ),
    "{name}: its transform is not finite; reset its location, rotation and scale": (
        "{name} : sa transformation n'est pas finie ; réinitialisez position, rotation et échelle"
    ),
    "object '{name}' has a scale of zero; give it one that can be inverted": (
        "l'objet « {name} » a une échelle nulle ; donnez-lui-en une autre"
    ),
    "{name}: with this instance the scene needs more than {size} GB, half of the memory here; reduce instances or "
    "render levels": (
        "{name} : avec cette instance la scène dépasse {size} Go, la moitié de la mémoire ; réduisez les instances ou "
        "les niveaux de rendu"
    ),
    "{name}: {defect} of vertices not finite or beyond {limit}; repair the mesh or the modifier that made it": (
        "{name} : {defect} de sommets non finies ou au-delà de {limit} ; réparez le maillage ou son modificateur"
    ),
    "{name}: {defect} of displaced vertices not finite or beyond {limit}; change the displacement of its materials": (
        "{name} : {defect} de sommets déplacés non finies ou au-delà de {limit} ; changez le déplacement de ses matériaux"
    ),
    "{name}: faces of its mesh use corners that are not there; remove the object, or make its mesh anew": (
        "{name} : des faces du maillage utilisent des coins absents ; supprimez l'objet ou refaites son maillage"
    ),
    "{owner}: {defect}; repair it and export again": "{owner} : {defect} ; à réparer, puis exportez à nouveau",
    "The shutter curve is nowhere open, or below 0; raise its points": (
        "La courbe de l'obturateur n'est nulle part ouverte, ou passe sous 0 ; relevez ses points"
    ),
    "{name}: moves with a scale of 0 at this frame; give it a scale above 0": (
        "{name} : se meut avec une échelle de 0 à cette image ; donnez-lui une échelle supérieure à 0"
    ),
    # The comparison.
    "{name}: cancelled before both sides had an image; there is nothing to compare": (
        "{name} : annulé avant que les deux côtés aient une image ; il n'y a rien à comparer"
    ),
    "cancelled before the image was finished; nothing of it is kept": "annulé avant la fin de l'image ; rien n'en reste",
    "{name}: light from materials that are not simulated reaches every pixel; simplify them, or lower the bounces": (
        "{name} : la lumière de matériaux non simulés atteint chaque pixel ; simplifiez-les ou réduisez les rebonds"
    ),
    "{name}: objects with faces cannot be told apart for motion blur; rename the namesakes": (
        "{name} : des objets ne peuvent être distingués pour le flou de mouvement ; renommez les homonymes"
    ),
    "--partial does not know motion blur; leave --partial or --motion-blur out": (
        "Partiel ne connaît pas le flou de mouvement ; désactivez l'un des deux"
    ),
    "{name} has no light passes; leave out --passes, or use a strategy of path tracing": (
        "{name} n'a pas de passes de lumière ; choisissez Passes de lumière : Aucune, ou une autre Stratégie"
    ),
    "{name}: light passes cannot be compared beside unsupported materials; leave out --passes": (
        "{name} : pas de passes de lumière à côté de matériaux non pris en charge ; choisissez Passes de lumière : Aucune"
    ),
    "Cycles wrote no pass '{name}'; compare without --passes and --lights": (
        "Cycles n'a pas écrit la passe « {name} » ; choisissez Passes de lumière : Aucune et désactivez Lampes"
    ),
    "{name}: no object has this name, so its light cannot be told apart; leave --lights out (probe: --no-lights)": (
        "{name} : aucun objet ne porte ce nom, sa lumière ne peut être distinguée ; désactivez Lampes"
    ),
    "{name}: it is linked from another file and takes no light group; leave --lights out (probe: --no-lights)": (
        "{name} : lié depuis un autre fichier, il n'accepte pas de groupe de lumières ; désactivez Lampes"
    ),
    "{count} lamps and emitting objects cannot be told apart, {most} can; leave --lights out (probe: --no-lights)": (
        "{count} lampes et objets émetteurs ne peuvent être distingués, {most} le peuvent ; désactivez Lampes"
    ),
    "light that volumes emit is no lamp's and no object's; leave --lights out (probe: --no-lights)": (
        "la lumière émise par des volumes n'est celle d'aucune lampe ni d'aucun objet ; désactivez Lampes"
    ),
    "{width} x {height} pixels: about {needed} GB to compare at full size; this machine has {size} GB; {remedy}": (
        "{width} x {height} pixels : environ {needed} Go pour comparer en entier ; cette machine a {size} Go ; {remedy}"
    ),
    "this machine has {size} GB; {remedy}": "cette machine a {size} Go ; {remedy}",
    # Models, which are typed.
    "--{option} {value} is for distributions of microfacets, and '{model}' has none; leave one of them out": (
        "{option} {value} est pour des distributions de microfacettes, et « {model} » n'en a pas ; ôtez l'un des deux"
    ),
    "{name} = {value} is out of range; give at least {low} and at most {high}": (
        "{name} = {value} est hors limites ; donnez au moins {low} et au plus {high}"
    ),
    "Student-t distribution: g = {value} is out of range; {remedy}": (
        "Distribution de Student : g = {value} est hors limites ; {remedy}"
    ),
    "unknown {kind} '{name}'; did you mean '{near}'?": "« {name} » est inconnu ({kind}) ; vouliez-vous dire « {near} » ?",
    "unknown {kind} '{name}'; choose from {known}": "« {name} » est inconnu ({kind}) ; choisissez parmi {known}",
    # Mistakes of Étalon's own.
    "{kind}: {error}; please report it with the console's text": (
        "{kind} : {error} ; merci de le signaler avec le texte de la console"
    ),
}
