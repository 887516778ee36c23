# SPDX-License-Identifier: GPL-3.0-or-later
"""Refusals in French: the templates of their parts, and how each reads.

The templates recognise the parts. Names of nodes, sockets and options stay as Blender's English interface has them,
which is what a message quotes.
"""

from __future__ import annotations

# What of a node, an object or the scene is not simulated. Those that begin with a comma or a space follow the node's name.
WHATS: dict[str, str] = {
    "hair curves": "les courbes de cheveux",
    "a point cloud": "un nuage de points",
    "a volume": "un volume",
    "grease pencil": "le crayon gras",
    "smoke": "la fumée",
    "particle hair": "les cheveux de particules",
    "the volume of a holdout": "le volume d'un cache (holdout)",
    "a rolling shutter": "un obturateur déroulant",
    "a shutter that does not open about the frame": "un obturateur qui n'est pas centré sur l'image",
    "a Shutter Curve that is not flat": "une courbe d'obturateur qui n'est pas plate",
    "a lens or a scale that is refused while the shutter is open": (
        "un objectif ou une échelle refusés pendant que l'obturateur est ouvert"
    ),
    "motion blur by the attribute 'velocity'": "le flou de mouvement par l'attribut « velocity »",
    "motion blur of a deforming mesh with custom normals, before Blender 5.2": (
        "le flou de mouvement d'un maillage qui se déforme et a des normales personnalisées, avant Blender 5.2"
    ),
    "motion blur of a deforming mesh whose material has a normal map or UV tangents": (
        "le flou de mouvement d'un maillage qui se déforme, dont le matériau a une carte de normales ou des tangentes UV"
    ),
    "motion blur of a deforming mesh whose objects have other Steps or Deformation": (
        "le flou de mouvement d'un maillage qui se déforme, dont les objets ont d'autres Steps ou Deformation"
    ),
    "motion blur of a light that appears": "le flou de mouvement d'une lampe qui apparaît",
    "motion blur of a mesh whose faces change while the shutter is open": (
        "le flou de mouvement d'un maillage dont les faces changent pendant que l'obturateur est ouvert"
    ),
    "motion blur of a moving light": "le flou de mouvement d'une lampe qui bouge",
    "motion blur of a scale of 0, or of one that changes its sign": (
        "le flou de mouvement d'une échelle de 0, ou qui change de signe"
    ),
    "motion blur of an object that appears or vanishes while the shutter is open": (
        "le flou de mouvement d'un objet qui apparaît ou disparaît pendant que l'obturateur est ouvert"
    ),
    "motion blur of lens, shift, clipping or focus that change while the shutter is open": (
        "le flou de mouvement d'un objectif, décalage, découpage ou foyer qui change pendant que l'obturateur est ouvert"
    ),
    "motion blur over a cut to another camera": "le flou de mouvement au passage à une autre caméra",
    "an image that shows little but shadow catchers": "une image qui ne montre guère que des capteurs d'ombres",
    "adaptive subdivision": "la subdivision adaptative",
    "shadow caustics": "les caustiques d'ombre",
    "Simplify": "Simplify",
    "stereoscopy": "la stéréoscopie",
    "leaving out its surfaces": "l'omission de ses surfaces",
    "a scale of 0 along an axis": "une échelle de 0 selon un axe",
    "a sheared matrix": "une matrice cisaillée",
    "a spread of 0": "une ouverture (spread) de 0",
    "negative power": "une puissance négative",
    "the lens type {name}": "le type d'objectif {name}",
    "light linking with more than {most} collections or sets of objects": (
        "la liaison de lumière avec plus de {most} collections ou ensembles d'objets"
    ),
    "shadow linking beside a volume": "la liaison d'ombres à côté d'un volume",
    "shadow linking of its faces beside the smooth material '{name}'": (
        "la liaison d'ombres de ses faces à côté du matériau lisse « {name} »"
    ),
    "ray visibility beside the volume of '{name}', which scatters,": (
        "la visibilité aux rayons à côté du volume de « {name} », qui diffuse"
    ),
    "light linking beside the volume of '{name}', which scatters,": (
        "la liaison de lumière à côté du volume de « {name} », qui diffuse"
    ),
    "ray visibility Volume Scatter off, beside a volume that scatters,": (
        "la visibilité Volume Scatter désactivée, à côté d'un volume qui diffuse"
    ),
    "a volume that emits light and absorbs none": "un volume qui émet de la lumière sans en absorber",
    "the volume of material '{name}' in an object that some rays do not meet": (
        "le volume du matériau « {name} » dans un objet que certains rayons ne voient pas"
    ),
    "the volume of material '{name}', because {defect},": "le volume du matériau « {name} » ({defect})",
    "subsurface scattering by several closures with different normals": (
        "la diffusion sous la surface par plusieurs fermetures de normales différentes"
    ),
    "subsurface scattering where the object may reach into the volume of '{name}'": (
        "la diffusion sous la surface là où l'objet peut entrer dans le volume de « {name} »"
    ),
    "attribute '{name}', by which a heterogeneous volume varies,": (
        "l'attribut « {name} », selon lequel varie un volume hétérogène"
    ),
    "attribute '{name}', which Cycles makes itself": "l'attribut « {name} », que Cycles crée lui-même",
    "attribute '{name}' of type {kind} on domain {domain}": "l'attribut « {name} » de type {kind} du domaine {domain}",
    "tile {number} of an image, which faces reach over without a corner in it (Cycles does not load it),": (
        "la tuile {number} d'une image, que des faces couvrent sans y avoir de coin (Cycles ne la charge pas)"
    ),
    "displacement (node '{name}', socket 'Displacement')": "le déplacement (nœud « {name} », entrée Displacement)",
    "the depth or length of rays beside {place}": "la profondeur ou la longueur des rayons à côté de {place}",
    "the subsurface scattering of '{name}'": "la diffusion sous la surface de « {name} »",
    "the volume of '{name}', which scatters": "le volume de « {name} », qui diffuse",
    "its emission": "son émission",
    "its subsurface scattering": "sa diffusion sous la surface",
    "what lets light straight through": "ce qui laisse passer la lumière tout droit",
    "a world that depends on the direction": "un monde qui dépend de la direction",
    "{what} beside a displacement": "{what} à côté d'un déplacement",
    "{what} in a displacement": "{what} dans un déplacement",
    "displacement of a mesh with custom normals or sharp edges, before Blender 5.2": (
        "le déplacement d'un maillage aux normales personnalisées ou aux arêtes vives, avant Blender 5.2"
    ),
    "Displacement and Bump, before Blender 5.2": "Displacement and Bump, avant Blender 5.2",
    "Displacement and Bump of a scaled object": "Displacement and Bump d'un objet mis à l'échelle",
    "Displacement and Bump by coordinates other than UV and Generated": (
        "Displacement and Bump selon d'autres coordonnées que UV et Generated"
    ),
    "a normal map or UV tangents of '{name}' beside Displacement and Bump": (
        "une carte de normales ou des tangentes UV de « {name} » à côté de Displacement and Bump"
    ),
    " with Displacement and Bump": " avec Displacement and Bump",
    "displacement of smooth faces without area": "le déplacement de faces lisses sans aire",
    "the displacement of '{name}', which depends on the object, of a mesh with several users,": (
        "le déplacement de « {name} », qui dépend de l'objet, d'un maillage à plusieurs utilisateurs"
    ),
    "displacement in tangent space of a mesh without a UV map": (
        "le déplacement en espace tangent d'un maillage sans carte UV"
    ),
    "the displacement of '{name}' on a mesh whose users have other materials,": (
        "le déplacement de « {name} » sur un maillage dont les utilisateurs ont d'autres matériaux"
    ),
    "a normal map or UV tangents of '{name}' on a displaced mesh, before Blender 5.2": (
        "une carte de normales ou des tangentes UV de « {name} » sur un maillage déplacé, avant Blender 5.2"
    ),
    "motion blur of a deforming mesh that a material displaces": (
        "le flou de mouvement d'un maillage qui se déforme et qu'un matériau déplace"
    ),
    "ambient occlusion in {place}": "l'occlusion ambiante dans {place}",
    "a Bevel node in {place}": "un nœud Bevel dans {place}",
    "Pixel Size of a Wireframe node in {place}": "l'option Pixel Size d'un nœud Wireframe dans {place}",
    "a panoramic view": "une vue panoramique",
    "a scene with subsurface scattering": "une scène avec diffusion sous la surface",
    "a scene with volumes that scatter": "une scène avec des volumes diffusants",
    "an orthographic view of oblong pixels": "une vue orthographique aux pixels oblongs",
    "a Bevel node with the strategy {name}": "un nœud Bevel avec la stratégie {name}",
    "the height of a bump": "la hauteur d'un relief",
    "'{output}' of a Light Path node in {place}": "« {output} » d'un nœud Light Path dans {place}",
    "{kind} '{name}' of the library '{path}', which is not there,": (
        "{kind} « {name} » de la bibliothèque « {path} », qui n'est pas là"
    ),
    "property '{label}' ({name})": "la propriété « {label} » ({name})",
    "Cycles' setting '{label}' ({name})": "le réglage de Cycles « {label} » ({name})",
    "{label} {value} (property {name})": "{label} {value} (propriété {name})",
    # What follows a node's name.
    " in a world": " dans un monde",
    " in a volume": " dans un volume",
    " on a surface": " sur une surface",
    " on a world": " sur un monde",
    " without a name": " sans nom",
    ", Sun Disc cut by the horizon,": ", Sun Disc coupé par l'horizon",
    ", Sun Disc outside of a world,": ", Sun Disc hors d'un monde",
    ", Sun Size below {least} degrees,": ", Sun Size au-dessous de {least} degrés",
    ", base Original,": ", base Original",
    ", behind a chain of {count} nodes,": ", derrière une chaîne de {count} nœuds",
    ", built-in texture mapping ({name}),": ", le placage de texture intégré ({name})",
    ", data type {name},": ", le type de données {name}",
    ", distribution {name},": ", la distribution {name}",
    ", image '{name}' (texels that are not finite),": ", l'image « {name} » (des texels non finis)",
    ", image '{name}' (tiled, {fault}),": ", l'image « {name} » (en tuiles, {fault})",
    ", image '{name}' (colour space {space}, {fault}),": (
        ", l'image « {name} » (espace colorimétrique {space}, {fault})"
    ),
    ", image '{name}' ({fault}),": ", l'image « {name} » ({fault})",
    ", image '{name}', {what},": ", l'image « {name} », {what}",
    ", name '{name}', which Cycles keeps for itself,": ", le nom « {name} », que Cycles se réserve",
    ", object '{name}',": ", l'objet « {name} »",
    ", option 'Invert' of Euler angles,": ", l'option Invert des angles d'Euler",
    ", option '{name}',": ", l'option « {name} »",
    ", property '{name}',": ", la propriété « {name} »",
    ", output 'Alpha', whose links lead nowhere,": ", la sortie Alpha, dont les liens ne mènent nulle part",
    ", output '{name}', to which the group leads nothing,": ", la sortie « {name} », que le groupe n'alimente pas",
    ", output '{name}', which is off in this operation,": ", la sortie « {name} », inactive dans cette opération",
    ", output '{name}', with its smoothness,": ", la sortie « {name} », avec son lissage",
    ", output '{name}',": ", la sortie « {name} »",
    ", phase function {name},": ", la fonction de phase {name}",
    ", projection Box in a world,": ", la projection Box dans un monde",
    ", projection {name} of a tiled image,": ", la projection {name} d'une image en tuiles",
    ", whose direction has no length,": ", dont la direction est de longueur nulle",
    ", whose input has no length,": ", dont l'entrée est de longueur nulle",
    ", socket 'Strength', below 0 in a volume,": ", l'entrée Strength, au-dessous de 0 dans un volume",
    ", socket 'Thin Film Thickness' in Blender before {first},": (
        ", l'entrée Thin Film Thickness dans Blender avant {first}"
    ),
    ", socket '{name}' (a heterogeneous volume),": ", l'entrée « {name} » (un volume hétérogène)",
    ", socket '{name}' (linked),": ", l'entrée « {name} » (liée)",
    ", socket '{name}' (textured),": ", l'entrée « {name} » (texturée)",
    ", socket '{name}' of type {kind},": ", l'entrée « {name} » de type {kind}",
    ", socket '{name}', a colour {bounds},": ", l'entrée « {name} », une couleur {bounds}",
    ", socket '{name}', which is not the same everywhere,": ", l'entrée « {name} », qui n'est pas la même partout",
    ", socket '{name}', whose {have} feeds a {want},": ", l'entrée « {name} », où {have} alimente {want}",
    ", socket '{name}',": ", l'entrée « {name} »",
    ", sockets 'Thin Film' (textured) above a diffuse base,": (
        ", les entrées Thin Film (texturées) sur une base diffuse"
    ),
    ", sockets 'Transmission Dispersion' (textured),": ", les entrées Transmission Dispersion (texturées)",
    ", through which a heterogeneous volume is mixed,": ", par lequel un volume hétérogène est mélangé",
    ", which passes nothing on,": ", qui ne transmet rien",
    ", in a world,": ", dans un monde",
    ", type {name},": ", le type {name}",
    # What is wrong with an image.
    "alpha {mode}": "alpha {mode}",
    "alpha {mode} in the colour space {space}": "alpha {mode} dans l'espace colorimétrique {space}",
    "alpha {mode} of an image that Blender keeps, whose texels follow the mode already when Cycles applies it": (
        "alpha {mode} d'une image que garde Blender, dont les texels suivent déjà le mode quand Cycles l'applique"
    ),
    "alpha {mode}, which Cycles before 5.1 takes for {natural}": "alpha {mode}, que Cycles avant 5.1 prend pour {natural}",
    "changes that are not saved": "des changements non enregistrés",
    "colours beyond its range": "des couleurs hors de ses limites",
    "movie, in a Blender without FFmpeg": "vidéo, dans un Blender sans FFmpeg",
    "no texels": "sans texels",
    "not saved": "non enregistrée",
    "of floats": "à virgule flottante",
    "packed": "empaquetée",
    "path '{path}'": "chemin « {path} »",
    "tinted greys": "des gris teintés",
}

REMEDIES: dict[str, str] = {
    "lower the resolution, or give a time and let a smaller image be compared": (
        "réduisez la résolution, ou donnez une durée et laissez comparer une image plus petite"
    ),
    "apply the scale of its parents": "appliquez l'échelle de ses parents",
    "choose the strategy visible": "choisissez la stratégie visible",
    "link it to the Normal of a BSDF, or unlink it": "reliez-le à la Normal d'un BSDF, ou retirez son lien",
    "choose Displaced": "choisissez Displaced",
    "choose Displacement Only or Bump Only": "choisissez Displacement Only ou Bump Only",
    "choose Displacement Only": "choisissez Displacement Only",
    "apply its scale, or choose Displacement Only": "appliquez son échelle, ou choisissez Displacement Only",
    "use these, or choose Displacement Only": "utilisez celles-ci, ou choisissez Displacement Only",
    "bake it to an image, or unlink it": "précalculez-le dans une image, ou retirez ce lien",
    "clear them and shade it smooth or flat": "effacez-les et ombrez-le lisse ou plat",
    "give it a UV map": "donnez-lui une carte UV",
    "make its mesh single-user": "rendez son maillage mono-utilisateur",
    "make its mesh single-user, or choose Object Space": "rendez son maillage mono-utilisateur, ou choisissez Object Space",
    "merge its vertices by distance, or shade it flat": "fusionnez ses sommets par distance, ou ombrez-le plat",
    "unlink the Normal Map node or Tangent": "retirez le lien du nœud Normal Map ou de Tangent",
    "choose Henyey-Greenstein": "choisissez Henyey-Greenstein",
    "choose another": "choisissez-en une autre",
    "choose another projection": "choisissez une autre projection",
    "choose another {label}, or use Blender {release}": "choisissez un autre {label}, ou utilisez Blender {release}",
    "choose another {label}": "choisissez un autre {label}",
    "choose the projection Flat": "choisissez la projection Flat",
    "choose the type Geometry on a surface": "choisissez le type Geometry sur une surface",
    "clear its Object field": "videz son champ Object",
    "close the mesh, with all faces of this material and turned outwards": (
        "fermez le maillage, toutes les faces de ce matériau et tournées vers l'extérieur"
    ),
    "convert it to a float, vector or colour of points, corners or faces": (
        "convertissez-le en nombre, vecteur ou couleur de points, de coins ou de faces"
    ),
    "convert it to {space}": "convertissez-la en {space}",
    "cut the faces at the tiles' borders": "coupez les faces aux bords des tuiles",
    "delete it": "supprimez-le",
    "do not render it": "excluez-le du rendu",
    "do without it": "passez-vous-en",
    "give it a scale above 0": "donnez-lui une échelle supérieure à 0",
    "give more than 1.5 and at most {most}; Beckmann's is the limit of large g": (
        "donnez plus de 1.5 et au plus {most} ; Beckmann est la limite des grands g"
    ),
    "give them faces (geometry nodes: Curve to Mesh with a Curve Circle as its profile), or do not render them": (
        "donnez-leur des faces (nœuds de géométrie : Curve to Mesh avec un Curve Circle pour profil), ou excluez-les du "
        "rendu"
    ),
    "have it absorb, or emit nothing": "faites-le absorber, ou n'émettre rien",
    "include it again": "incluez-le à nouveau",
    "link a Tangent node to it, or nothing": "liez-y un nœud Tangent, ou rien",
    "link fewer": "liez-en moins",
    "link the same Normal to all of them": "liez la même Normal à toutes",
    "make it perspective, orthographic or panoramic": "rendez-la perspective, orthographique ou panoramique",
    "make the power positive": "rendez la puissance positive",
    "mix values, vectors or colours": "mélangez des valeurs, des vecteurs ou des couleurs",
    "move them apart": "écartez-les",
    "name an attribute of the mesh": "nommez un attribut du maillage",
    "put spheres in its place (geometry nodes: Instance on Points with an Ico Sphere), or do not render it": (
        "mettez des sphères à sa place (nœuds de géométrie : Instance on Points avec une Ico Sphere), ou excluez-le du "
        "rendu"
    ),
    "remove one of the two": "retirez l'un des deux",
    "remove the blockers, or the volume": "retirez les bloqueurs, ou le volume",
    "rename it": "renommez-le",
    "rename the attribute": "renommez l'attribut",
    "repair the image": "réparez l'image",
    "replace it by a supported node or bake it to an image": (
        "remplacez-le par un nœud pris en charge ou précalculez-le dans une image"
    ),
    "replace it by a supported shader": "remplacez-le par un shader pris en charge",
    "reset it and use a Mapping node": "réinitialisez-le et utilisez un nœud Mapping",
    "restore its file, or choose another image": "rétablissez son fichier, ou choisissez une autre image",
    "restore or relink the library, or do not render it": (
        "rétablissez ou reliez la bibliothèque, ou excluez l'objet du rendu"
    ),
    "save it: Cycles reads the files": "enregistrez-la : Cycles lit les fichiers",
    "save or pack the image: Cycles reads the file": "enregistrez ou empaquetez l'image : Cycles lit le fichier",
    "give them the same": "donnez-leur les mêmes",
    "keep them constant, or leave --motion-blur out": "gardez-les constants, ou désactivez Flou de mouvement",
    "leave --motion-blur out": "désactivez Flou de mouvement",
    "make its points equally high, above 0": "mettez ses points à la même hauteur, au-dessus de 0",
    "move the marker out of the shutter's time": "sortez le marqueur du temps de l'obturateur",
    "remove the attribute, or switch Deformation off in its motion blur settings": (
        "supprimez l'attribut, ou désactivez Deformation dans ses réglages de flou"
    ),
    "set Position to Center on Frame": "réglez Position sur Center on Frame",
    "set Rolling Shutter to None": "réglez Rolling Shutter sur None",
    "clear its custom normals, or switch Deformation off in its motion blur settings": (
        "effacez ses normales personnalisées, ou désactivez Deformation dans ses réglages de flou"
    ),
    "switch Deformation off in its motion blur settings": "désactivez Deformation dans ses réglages de flou",
    "set Render As of its particles to Object, or do not render it": (
        "réglez Render As de ses particules sur Object, ou excluez-le du rendu"
    ),
    "set a direction as its Normal": "réglez une direction comme Normal",
    "set it back to its default": "remettez sa valeur par défaut",
    "set it back to {value}": "remettez {value}",
    "set it to 0, or use a newer Blender": "mettez 0, ou utilisez un Blender plus récent",
    "set it to {value}": "mettez {value}",
    "set its Alpha to {value}, Channel Packed or None": "réglez son Alpha sur {value}, Channel Packed ou None",
    "set its Alpha to None": "réglez son Alpha sur None",
    "shorten the chain, or bake it to an image": "raccourcissez la chaîne, ou précalculez-la dans une image",
    "switch Sun Disc off and add a sun lamp": "désactivez Sun Disc et ajoutez une lampe soleil",
    "switch Sun Disc off": "désactivez Sun Disc",
    "switch its ray visibility on": "activez sa visibilité aux rayons",
    "switch Pixel Size off": "désactivez Pixel Size",
    "switch it off": "désactivez-le",
    "switch it on": "activez-la",
    "this Blender ({version}) lacks its type; use the version that made it, or delete it": (
        "son type manque à ce Blender ({version}) ; utilisez la version qui l'a créé, ou supprimez-le"
    ),
    "turn its ball": "tournez sa boule",
    "turn by an axis and an angle": "tournez par un axe et un angle",
    "link it to a factor of a diffuse colour, or unlink it": (
        "reliez-la à un facteur d'une couleur diffuse, ou retirez son lien"
    ),
    "unlink the Light Path node": "retirez le lien du nœud Light Path",
    "unlink Displacement, or link a Displacement node": "retirez le lien de Displacement, ou liez-y un nœud Displacement",
    "unlink Displacement, or use a Bump node": "retirez le lien de Displacement, ou utilisez un nœud Bump",
    "switch the holdout off": "désactivez le cache (holdout)",
    "switch Shadow Catcher off": "désactivez Capteur d'ombres (Shadow Catcher)",
    "unlink IOR, or choose GGX": "retirez le lien de IOR, ou choisissez GGX",
    "unlink it: only volumes that are the same everywhere are simulated": (
        "retirez ce lien : seuls les volumes partout les mêmes sont simulés"
    ),
    "unlink it": "retirez ce lien",
    "unlink them, or choose GGX": "retirez leurs liens, ou choisissez GGX",
    "unlink them, or make it all metal or transmission": "retirez leurs liens, ou mettez-le tout en métal ou en transmission",
    "unlink {name}": "retirez le lien de {name}",
    "unpack it": "dépaquetez-la",
    "use Is Camera Ray or ray visibility": "utilisez Is Camera Ray ou la visibilité aux rayons",
    "use Quadratic, and a Smooth of 0": "utilisez Quadratic, et un Smooth de 0",
    "use Texture Coordinate, Generated": "utilisez Texture Coordinate, Generated",
    "use a Tangent node": "utilisez un nœud Tangent",
    "use a light, or remove its blockers": "utilisez une lampe, ou retirez ses bloqueurs",
    "use a sequence of image files": "utilisez une suite de fichiers d'images",
    "use a still image or a sequence of image files": "utilisez une image fixe ou une suite de fichiers d'images",
    "use another output, or none": "utilisez une autre sortie, ou aucune",
    "use constant colours and factors": "utilisez des couleurs et des facteurs constants",
    "use one plain Emission node": "utilisez un seul nœud Emission simple",
    "use the node that gives it": "utilisez le nœud qui le donne",
    "use {names} of a surface": "utilisez {names} d'une surface",
    "use {names}": "utilisez {names}",
    "widen the spread, or use a sun": "élargissez l'ouverture, ou utilisez un soleil",
    "write <UDIM> or <UVTILE> where its number stands": "écrivez <UDIM> ou <UVTILE> à la place de son numéro",
}
