# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on in other languages: labels, names of operators and their tooltips, what panels say. Where Blender
knows a word itself its own comes first, but for the labels of keys. What the core says of a shot is English.

Another language is another table. Words in braces are numbers or names, and stay.
"""

import re

import bpy

from .properties import FIELDS, entry_fields, label_of, switch_tooltip, tooltip

GERMAN = {
    # Tables of keys, panels
    "Sea": "Seegang", "Waves": "Wellen", "Surface": "Oberfläche", "Effects": "Effekte", "Light": "Licht", "Output": "Ausgabe",
    "Water": "Wasser", "Quality": "Qualität", "Shot": "Aufnahme", "More": "Weiteres", "Presets": "Voreinstellungen", "Floating": "Schwimmt",
    "Pelagic Bake": "Pelagic-Bake", "Pelagic Ocean": "Pelagic-Ozean", "Pelagic Volume": "Pelagic-Volumen",
    "Viewport Preview": "Vorschau in der Ansicht", "In the Sea's Light": "Im Licht der See", "Check for the Farm": "Für die Renderfarm prüfen",
    "Write a Job for the Farm": "Auftrag für die Renderfarm schreiben",
    "The mesh is linked, which plays slowly. Object, Relations, Make Local plays fast":
        "Das Netz ist verknüpft und spielt langsam. Objekt, Relationen, Lokal machen spielt schnell",
    # Keys
    "Seed": "Startwert", "Loop": "Schleife", "Time scale": "Zeitmaßstab", "Time offset": "Zeitversatz",
    "Wind speed": "Windgeschwindigkeit", "Wind direction": "Windrichtung", "Wind fetch": "Streichlänge", "Depth": "Wassertiefe",
    "Spectrum": "Spektrum", "Growth": "Wachstum", "Sky rotation": "Himmelsdrehung", "Sky gain": "Himmelsverstärkung", "Height and peak": "Höhe und Spektralgipfel", "Short waves": "Kurze Wellen", "Significant height": "Signifikante Wellenhöhe",
    "Spreading": "Richtungsverteilung", "Directionality": "Richtungsbündelung", "Gust strength": "Böenstärke",
    "Gust size": "Böengröße", "Gust fronts": "Böenfronten", "Speed": "Geschwindigkeit", "Rain": "Regen", "Swell": "Dünung", "Height": "Höhe", "Period": "Periode", "Direction": "Richtung",
    "Spectrum file": "Spektrumsdatei", "Spectrum time": "Zeit des Spektrums", "Model": "Modell", "Choppiness": "Zuspitzung",
    "Lean": "Vorneigung", "Second order": "Zweite Ordnung",
    "Cascades": "Kaskaden", "Size": "Größe", "Resolution": "Auflösung", "Tiling": "Kachelung", "Band gains": "Bandverstärkungen", "Heroes": "Einzelwellen", "Masks": "Masken", "Picture": "Bild", "Vessels": "Schiffe", "Path": "Pfad", "Interpolation": "Interpolation", "Beam": "Breite", "Draught": "Tiefgang", "Linear": "Linear", "Smooth": "Weich", "Edge": "Rand", "Ripples": "Kräuselwellen", "Foam": "Schaum", "East": "Osten", "North": "Norden",
    "From": "Von", "To": "Bis", "Gain": "Verstärkung", "Trains": "Wellenzüge", "Shortest": "Kürzeste", "Longest": "Längste", "Coast": "Küste",
    "Kind": "Art", "Cell": "Zelle", "Earth curvature": "Erdkrümmung", "Cage file": "Käfigdatei", "Cage level": "Käfigstufe", "Beyond": "Jenseits",
    "Sun elevation": "Sonnenhöhe", "Sun azimuth": "Sonnenazimut", "Sky": "Himmel", "Turbidity": "Trübung der Luft",
    "Visibility": "Sichtweite", "Camera": "Kamera", "Light meter": "Belichtungsmesser", "Type": "Wasserart", "Body": "Wasserkörper", "Floor colour": "Farbe des Grundes", "Crest light": "Licht durch Kämme",
    "Floor pattern": "Muster des Grundes", "Caustics": "Kaustik", "Depth file": "Tiefenkarte", "Depth size": "Breite der Tiefenkarte",
    "Depth east": "Tiefenkarte, Ost", "Depth north": "Tiefenkarte, Nord",
    "Bubbles": "Blasen", "Whitecaps": "Schaumkronen", "Whitecap law": "Schaumkronengesetz",
    "Sea warmer than air": "See wärmer als Luft", "Whitecap amount": "Menge der Schaumkronen", "Breaking from": "Brecher ab",
    "Foam decay": "Schaumabbau", "Foam drift": "Schaumdrift", "Foam structure": "Schaumstruktur", "Foam streaks": "Schaumstreifen",
    "Foam pattern": "Schaummuster", "Foam new albedo": "Albedo frischen Schaums", "Foam old albedo": "Albedo alten Schaums",
    "Foam new opaque": "Deckkraft frischen Schaums", "Foam old opaque": "Deckkraft alten Schaums",
    "Spray": "Gischt", "Spray law": "Gischtgesetz", "Spray gain": "Gischtverstärkung", "Spray drops": "Gischttropfen", "Level": "Stufe", "Max error": "Größter Fehler", "Frame": "Einzelbild",
    "Mesh": "Netz", "Attributes": "Attribute", "Maps": "Karten", "Map resolution": "Kartenauflösung",
    "Cascade tiles": "Kaskadenkacheln", "Mesh scheme": "Netzschema", "Volumes": "Volumen", "Drops": "Tropfen",
    # Choices
    "Pierson moskowitz": "Pierson-Moskowitz", "Jonswap 1973": "JONSWAP 1973", "Donelan banner": "Donelan-Banner", "File": "Datei",
    "None": "Keine", "Cosine": "Kosinus", "Trochoid": "Trochoide", "Random": "Zufällig", "Periodic": "Periodisch",
    "Patch": "Ausschnitt", "Projected grid": "Projiziertes Gitter", "Near far": "Nah bis fern", "Cage": "Käfig", "By kind": "Je nach Art", "Nothing": "Nichts", "Ocean": "Ozean",
    "Coastal": "Küste", "Turbid": "Trüb", "Draft": "Entwurf", "Preview": "Vorschau", "Final": "Endfassung", "Reference": "Referenz",
    "Custom budget": "Eigenes Budget", "Normal": "Normale", "Velocity": "Geschwindigkeit", "Slope variance": "Neigungsvarianz",
    "Displacement": "Auslenkung", "Floor": "Boden", "CatmullClark": "Catmull-Clark", "Level set": "Level-Set",
    # What Blender alone has
    "To the horizon": "Bis zum Horizont", "UV Map": "UV-Karte", "See Through": "Durchsichtig", "See Through by Hand": "Durchsichtig nach Wahl",
    "Viewport": "Ansicht",
    "Viewport at Most": "Ansicht höchstens", "Size by Hand": "Größe von Hand", "Length": "Länge", "Width": "Breite",
    "Damping": "Dämpfung", "Tilt": "Neigung", "Drift": "Drift", "Folder": "Ordner", "Offset": "Versatz", "Halvings": "Halbierungen",
    "Bake": "Backen", "Exposure": "Belichtung", "Sun and Sky": "Sonne und Himmel", "See the horizon": "Horizont sehen",
    "Volume": "Volumen", "Camera and Frames": "Kamera und Bilder", "Material, Sun and Sky": "Material, Sonne und Himmel",
    "Name": "Name", "Into": "Wohin", "Keyframes": "Keyframes", "Attribute": "Attribut", "Text": "Text", "File Path": "Dateipfad",
    "Use Existing Materials": "Vorhandene Materialien",
    # Operators
    "Add": "Hinzufügen", "Remove": "Entfernen", "Delete": "Löschen", "Stop": "Anhalten", "Water Material": "Wassermaterial",
    "Bake Volume": "Volumen backen", "Bake Spray Volume": "Gischt als Volumen backen",
    "Bake Level Set Volume": "Level-Set als Volumen backen", "Export Pelagic Shot": "Pelagic-Aufnahme exportieren",
    "Import Pelagic Shot": "Pelagic-Aufnahme importieren", "Pelagic Shot (.toml)": "Pelagic-Aufnahme (.toml)",
    "Pelagic Bake (.json, .usda)": "Pelagic-Bake (.json, .usda)", "Play Pelagic Bake": "Pelagic-Bake abspielen",
    "Float": "Schwimmen lassen", "Float No More": "Nicht mehr schwimmen lassen", "Apply Preset": "Voreinstellung anwenden",
    "Delete Preset": "Voreinstellung löschen", "Save Preset": "Voreinstellung speichern", "Save…": "Speichern …",
    "Add to Sea": "In die See setzen", "Take from Sea": "Aus der See nehmen", "Triangles": "Dreiecke", "Buoyancy": "Auftrieb", "On the Water": "Auf dem Wasser",
    "By Its Mass": "Nach seiner Masse", "Roll damping": "Rolldämpfung", "Caustics": "Kaustiken", "Catches": "Fängt auf",
    "Shadow and Reflection Catcher": "Fänger für Schatten und Spiegelbild",
    "Make Wake": "Kielwasser machen", "Mask from Painted Mesh": "Maske aus bemaltem Netz", "Release Mesh": "Netz freigeben", "Replace Ocean Modifier": "Ozean-Modifikator ersetzen",
    "Sample Sea Heights": "Wasserstand abtasten", "Use Mesh as Cage of an Ocean": "Netz als Käfig eines Ozeans",
    "Use Mesh as Ocean": "Netz als Ozean",
    # Tooltips
    "Add the open sea: its surface, water, sun and sky, moving with the timeline":
        "Die offene See hinzufügen: Oberfläche, Wasser, Sonne und Himmel, bewegt von der Zeitleiste",
    "Make the active mesh a sea: its vertices are the surface at rest":
        "Aus dem aktiven Netz eine See machen: seine Punkte sind die Oberfläche in Ruhe",
    "Add a sea on the smooth surface of the active mesh, its creases kept: the mesh is its cage, and can go on changing":
        "Eine See auf der glatten Fläche des aktiven Netzes, mit seinen Falten: es ist ihr Käfig und darf sich weiter ändern",
    "Let the active object leave a wake: its movement in the scene's frames becomes the path of a vessel of the ocean":
        "Das aktive Objekt ein Kielwasser ziehen lassen: seine Bewegung in den Bildern der Szene wird zum Pfad eines Schiffs des Ozeans",
    "Calm the ocean where the active mesh is painted, or make it rough: its colours become the picture of a mask. Done again, the mask has the new picture":
        "Den Ozean beruhigen, wo das aktive Netz bemalt ist, oder aufrauen: seine Farben werden zum Bild einer Maske. Noch einmal, und die Maske hat das neue Bild",
    "Make the ocean an ordinary mesh again: its own vertices go back to rest, another's stay as they are":
        "Den Ozean wieder zum gewöhnlichen Netz machen: eigene Punkte kehren in die Ruhelage zurück, andere bleiben",
    "Weathers and seas with a name, and your own: one makes itself the ocean's sea":
        "Wetter und Seegänge mit Namen, auch eigene: ein Klick macht sie zum Seegang des Ozeans",
    "Keep the ocean's sea, light and water under a name, for all files":
        "Seegang, Licht und Wasser des Ozeans unter einem Namen behalten, für alle Dateien",
    "Make the ocean's sun and sky the scene's: a world, a lamp, and the exposure for them":
        "Sonne und Himmel des Ozeans für die Szene: eine Welt, eine Lampe und die Belichtung dafür",
    "Put the selected objects into the sea's light, or take them out: an exported shot has them, with all that is parented to them, and pelagic render draws their shadow and mirror image":
        "Die ausgewählten Objekte ins Licht der See setzen oder herausnehmen: eine exportierte Aufnahme hat sie mit allem, was an ihnen hängt, und pelagic render zeichnet ihren Schatten und ihr Spiegelbild",
    "A shot that is exported has this object, with what is parented to it: pelagic render draws it, its shadow and its mirror image":
        "Eine exportierte Aufnahme hat dieses Objekt mit allem, was daran hängt: pelagic render zeichnet es, seinen Schatten und sein Spiegelbild",
    "How many of its triangles a shot has, by Blender's Decimate: all, or a share where the object is far":
        "Wie viele seiner Dreiecke eine Aufnahme hat, durch Blenders Dezimieren: alle, oder einen Teil, wo das Objekt fern ist",
    "How it floats in the pictures of a shot; in Blender it lies on the water":
        "Wie es in den Bildern einer Aufnahme schwimmt; in Blender liegt es auf dem Wasser",
    "How much waves gather the sun's light that they mirror onto it, 1 as it is. Pictures of a shot have it; Cycles and the viewport don't":
        "Wie sehr Wellen das Sonnenlicht bündeln, das sie darauf spiegeln, 1 wie es ist. Bilder einer Aufnahme haben es; Cycles und die Ansicht nicht",
    "By its mass: a bare hull has 0.05, one with bilge keels 0.1, a yacht under sail 0.4":
        "Nach seiner Masse: ein bloßer Rumpf hat 0,05, einer mit Schlingerkielen 0,1, eine Yacht unter Segeln 0,4",
    "It lies on the water under it": "Es liegt auf dem Wasser unter ihm",
    "It answers late, and rolls on, as a ship as long, wide and deep does":
        "Es antwortet verspätet und rollt nach, wie ein Schiff, das so lang, breit und tief ist",
    "Leave the sea out of Cycles' pictures but for what the scene's objects change on it, their shadow and their mirror image; or show it again":
        "Von der See in Bildern von Cycles nur zeigen, was die Objekte der Szene auf ihr ändern, Schatten und Spiegelbild; oder sie wieder zeigen",
    "Vertices a side while you work, as a share of what a render has":
        "Punkte je Seite beim Arbeiten, als Anteil an denen eines Renderings",
    "How much time accuracy may take: a level, or a budget of error or of time that chooses the settings":
        "Wie viel Zeit Genauigkeit kosten darf: eine Stufe, oder ein Budget an Fehler oder Zeit, das die Einstellungen wählt",
    "Rings of ever larger quads round the patch, out to 90 km. A bake leaves them out":
        "Ringe immer größerer Vierecke um den Ausschnitt, bis 90 km weit. Ein Bake lässt sie weg",
    "Texture coordinates for image textures. Pelagic's own materials read rest_position instead: with the map a large mesh takes a third more memory, and Blender copies it more slowly":
        "Texturkoordinaten für Bildtexturen. Pelagics eigene Materialien lesen stattdessen rest_position: Mit der Karte braucht ein großes Netz ein Drittel mehr Speicher, und Blender kopiert es langsamer",
    "The attribute velocity [m/s], for materials and modifiers of your own. With the scene's motion blur it is there in any case":
        "Das Attribut velocity [m/s], für eigene Materialien und Modifikatoren. Mit der Bewegungsunschärfe der Szene ist es immer da",
    "The cheapest settings within an error, or the most accurate within a time":
        "Die billigsten Einstellungen innerhalb eines Fehlers, oder die genauesten innerhalb einer Zeit",
    "The mesh whose smooth limit surface the sea lies on, with its creases. Without one it is the cage's file":
        "Das Netz, auf dessen glatter Grenzfläche die See liegt, mit seinen Falten. Ohne eines ist es die Käfigdatei",
    "The object's own vertices are the sea at rest; their places are in the attribute rest_position":
        "Die eigenen Punkte des Objekts sind die See in Ruhe; ihre Orte stehen im Attribut rest_position",
    "Vertices while you work: a patch or a projected grid that would have more is coarser than in a render. 0: as many as there are":
        "Punkte beim Arbeiten: Ein Ausschnitt oder projiziertes Gitter, das mehr hätte, ist gröber als im Rendering. 0: so viele, wie es sind",
    "What is under the surface shows in Cycles, dimmed and coloured by the water: absorption and scattering as a volume, which takes longer to render. Off, the water is opaque, with the same light from below":
        "Was unter der Oberfläche ist, zeigt sich in Cycles, vom Wasser gedämpft und gefärbt: Absorption und Streuung als Volumen, was länger rendert. Aus, ist das Wasser undurchsichtig, mit demselben Licht von unten",
    "Whether you choose if the water is seen through; otherwise it is where its floor is near enough to show, and while the camera is under water":
        "Ob du wählst, ob das Wasser durchsichtig ist; sonst ist es das, wo sein Grund nahe genug ist, um zu sehen zu sein, und während die Kamera unter Wasser ist",
    "Along the object's x axis, on the water": "Entlang der x-Achse des Objekts, auf dem Wasser",
    "Along the object's y axis, on the water": "Entlang der y-Achse des Objekts, auf dem Wasser",
    "How many times its own size the water is averaged over: 0 follows every ripple, 1 is a raft, more a heavy hull":
        "Über das Wievielfache seiner Größe das Wasser gemittelt wird: 0 folgt jeder Kräuselwelle, 1 ist ein Floß, mehr ein schwerer Rumpf",
    "How much it goes to and fro with the water: 0 keeps its place on the map, 1 goes as a cork does":
        "Wie sehr es mit dem Wasser hin und her geht: 0 bleibt an seinem Ort, 1 geht wie ein Korken",
    "How much of the water's slope it takes: 0 stays upright, 1 lies on the water":
        "Wie viel von der Neigung des Wassers es annimmt: 0 bleibt aufrecht, 1 liegt auf dem Wasser",
    "Length and width on the water instead of those of the object's box": "Länge und Breite auf dem Wasser statt der Maße des Objekts",
    "The object follows the water: place it as it lies in calm water":
        "Das Objekt folgt dem Wasser: Stelle es so, wie es in ruhigem Wasser liegt",
    "The ocean it floats in; empty: the scene's first": "Der Ozean, in dem es schwimmt; leer: der erste der Szene",
    "Where bakes go, each into a folder of its name; // is beside the .blend":
        "Wohin Bakes gehen, jeder in einen Ordner seines Namens; // ist neben der .blend",
    "Frames by which it is later than in the bake": "Bilder, um die es später ist als im Bake",
    "NAME.json in the folder of the bake that this object plays": "NAME.json im Ordner des Bakes, den dieses Objekt abspielt",
    "Of a fitted cage: how often each of its quads' sides is halved. Every vertex lies on the sea; more of them follow it between those of the cage":
        "Eines angepassten Käfigs: wie oft jede Seite seiner Vierecke halbiert wird. Jeder Punkt liegt auf der See; mehr davon folgen ihr zwischen denen des Käfigs",
    "Draw the sky and the sun behind everything, too": "Auch den Himmel und die Sonne hinter allem zeichnen",
    "Set the picture's exposure for the light": "Die Belichtung des Bildes auf das Licht einstellen",
    "Give the ocean its own material in place of the one it has": "Dem Ozean sein eigenes Material geben statt dem, das er hat",
    "Give the scene the ocean's sun and sky. Unless asked for, a world of your own stays":
        "Der Szene Sonne und Himmel des Ozeans geben. Wenn nicht verlangt, bleibt eine eigene Welt",
    "Raise the clipping distance of the camera and of the views": "Den Sichtbereich der Kamera und der Ansichten vergrößern",
    "Bake the scene's frames of the ocean to disk, as USD and maps. Esc stops it; the next bake goes on from there":
        "Die Bilder der Szene vom Ozean auf die Platte backen, als USD und Karten. Esc hält an; der nächste Bake macht dort weiter",
    "Bake a volume of the ocean for the scene's frames, and show it. Esc stops it; the next bake goes on from there":
        "Ein Volumen des Ozeans für die Bilder der Szene backen und zeigen. Esc hält an; der nächste Bake macht dort weiter",
    "Droplets over breaking crests: how much they dim light, in 1/m, and how they fly":
        "Tröpfchen über brechenden Kämmen: wie sehr sie Licht dämpfen, in 1/m, und wie sie fliegen",
    "The distance from the sea's surface, below it negative: what a simulation of water starts from":
        "Der Abstand von der Oberfläche der See, darunter negativ: womit eine Simulation von Wasser beginnt",
    "{}. Baked for the scene's frames, over the patch's square":
        "{}. Für die Bilder der Szene gebacken, über dem Quadrat des Ausschnitts",
    "Say whether farm nodes need the add-on for this scene, what for, and which files are missing or have absolute paths":
        "Sagen, ob die Rechner der Farm das Add-on für diese Szene brauchen, wofür, und welche Dateien fehlen oder absolute Pfade haben",
    "Write the ocean with the scene's camera and frames as a shot file, for pelagic bake and pelagic render":
        "Den Ozean mit Kamera und Bildern der Szene als Aufnahme schreiben, für pelagic bake und pelagic render",
    "Let the selected objects float, or let them float no more": "Die ausgewählten Objekte schwimmen lassen, oder nicht mehr",
    "Add the ocean of a shot file with its camera, sun and sky, and give the scene its frames":
        "Den Ozean einer Aufnahme mit Kamera, Sonne und Himmel hinzufügen und der Szene ihre Bilder geben",
    "Add the shot's camera, and give the scene its range, rate and resolution":
        "Die Kamera der Aufnahme hinzufügen und der Szene Bereich, Rate und Auflösung geben",
    "Add an entry; of a hero wave and a gust's front, at the 3D cursor in the current frame; of a mask, a calm at the 3D cursor; of a vessel, a course across it":
        "Einen Eintrag hinzufügen; eine Einzelwelle und eine Böenfront am 3D-Cursor im aktuellen Bild; bei Masken eine ruhige Stelle am 3D-Cursor; bei Schiffen einen Kurs durch ihn",
    "Remove this entry": "Diesen Eintrag entfernen",
    "Whose numbers or colours count; without a name the active colours do":
        "Wessen Zahlen oder Farben zählen; ohne Namen die aktiven Farben",
    "Give it the ocean's material, and a scene without oceans the bake's sun and sky":
        "Ihm das Material des Ozeans geben, und einer Szene ohne Ozeane Sonne und Himmel des Bakes",
    "Show a baked ocean from disk: nothing is simulated": "Einen gebackenen Ozean von der Platte zeigen: nichts wird simuliert",
    "Make this the ocean's sea": "Dies zum Seegang des Ozeans machen",
    "Make this sea of your own the ocean's, with its waves, effects, light and water":
        "Diese eigene See zu der des Ozeans machen, mit Wellen, Effekten, Licht und Wasser",
    "Delete a preset of your own": "Eine eigene Voreinstellung löschen",
    "Make the object's Ocean modifier the nearest Pelagic ocean, in the same place, of the same size and material":
        "Aus dem Ozean-Modifikator des Objekts den nächsten Pelagic-Ozean machen, am selben Ort, mit gleicher Größe und gleichem Material",
    "A table in the text editor: frame, object, x, y and the water's z over the scene's frames":
        "Eine Tabelle im Texteditor: Bild, Objekt, x, y und z des Wassers über die Bilder der Szene",
    "The selected objects' z over the scene's frames: they ride up and down":
        "z der ausgewählten Objekte über die Bilder der Szene: Sie gehen auf und ab",
    "Write down how high the water is where the selected objects or the active mesh's vertices are":
        "Aufschreiben, wie hoch das Wasser ist, wo die ausgewählten Objekte oder die Punkte des aktiven Netzes sind",
    "sea_height of the active mesh's vertices at this frame, in the world's z":
        "sea_height der Punkte des aktiven Netzes in diesem Bild, in z der Welt",
    "Stop the bake; the next one goes on from there": "Den Bake anhalten; der nächste macht dort weiter",
    "Draw the sea in solid views as it is lit, to the horizon, and hide its mesh; or stop that":
        "Die See in soliden Ansichten beleuchtet bis zum Horizont zeichnen und ihr Netz verbergen; oder damit aufhören",
    "Write the bake as a job for a render farm, into its folder, instead of running it: the shot, the files that it names, and scripts":
        "Den Bake als Auftrag für eine Renderfarm in seinen Ordner schreiben, statt ihn auszuführen: die Aufnahme, die Dateien, die sie nennt, und Skripte",
    "{}. Sets {}": "{}. Setzt {}",
    "Like a mirror": "Wie ein Spiegel",
    "Ripples without crests": "Kräuselwellen ohne Kämme",
    "Small wavelets, glassy crests that don't break": "Kleine Wellen, glasige Kämme, die nicht brechen",
    "Large wavelets, the first scattered whitecaps": "Größere Wellen, vereinzelte erste Schaumkronen",
    "Small waves that grow longer, fairly frequent whitecaps; 1 m":
        "Kleine Wellen, die länger werden, ziemlich häufige Schaumkronen; 1 m",
    "Moderate, long waves, many whitecaps; 2 m": "Mäßige, lange Wellen, viele Schaumkronen; 2 m",
    "Large waves, white crests everywhere; 3 m": "Große Wellen, überall weiße Kämme; 3 m",
    "The sea heaps up, foam begins to be blown in streaks; 4 m": "Die See türmt sich, Schaum beginnt, in Streifen zu wehen; 4 m",
    "Moderately high, longer waves, foam in marked streaks; 5.5 m": "Mäßig hohe, längere Wellen, Schaum in deutlichen Streifen; 5,5 m",
    "High waves, dense streaks, crests begin to topple; 7 m": "Hohe Wellen, dichte Streifen, Kämme beginnen zu stürzen; 7 m",
    "Very high waves with overhanging crests, the sea looks white; 9 m":
        "Sehr hohe Wellen mit überhängenden Kämmen, die See sieht weiß aus; 9 m",
    "Exceptionally high waves, long white patches everywhere; 11.5 m": "Außergewöhnlich hohe Wellen, überall lange weiße Flächen; 11,5 m",
    "The air is full of foam, the sea white; 14 m": "Die Luft ist voll Schaum, die See weiß; 14 m",
    "Long swell without wind, the sun low": "Lange Dünung ohne Wind, tiefe Sonne",
    "A steady breeze over deep blue water, the sun high": "Stetige Brise über tiefblauem Wasser, hohe Sonne",
    "Short, steep waves over shallow green water": "Kurze, steile Wellen über flachem grünem Wasser",
    "Clear, shallow water over coral sand, a light wind": "Klares, flaches Wasser über Korallensand, leichter Wind",
    "Light wind, the sun's path on the water": "Leichter Wind, die Bahn der Sonne auf dem Wasser",
    "A storm over a shelf sea, streaked with foam": "Sturm über einem Schelfmeer, von Schaum gestreift",
    "A gale over a swell as high as a house": "Stürmischer Wind über haushoher Dünung",
    # What tooltips say of keys and of their words
    "Another seed, another sea of the same weather": "Ein anderer Startwert, eine andere See desselben Wetters",
    "Above 0: the sea repeats exactly after this long, a whole number of frames":
        "Über 0: Nach dieser Zeit, einer ganzen Zahl von Bildern, wiederholt sich die See genau",
    "Seconds of the sea in a second on the screen: 0.5 is slow motion, 0 stands still":
        "Sekunden der See in einer Sekunde auf dem Bildschirm: 0,5 ist Zeitlupe, 0 steht still",
    "The sea's time at frame 1": "Die Zeit der See in Bild 1",
    "10 m above the sea": "10 m über der See",
    "Blowing towards, counter-clockwise from +x (east)": "Wohin er weht, gegen den Uhrzeigersinn von +x (Osten)",
    "How far the wind has blown over water: little gives a short, steep sea":
        "Wie weit der Wind über Wasser geweht hat: wenig macht eine kurze, steile See",
    "Of the water": "Des Wassers",
    "How deep the floor lies that is seen, in metres: a picture of depths from above, north at its top, grey or its red, or a mesh of the floor, z up, which lies where it lies in the world; beyond it the floor goes to Depth. Waves are those of Depth, and feel it with Coast":
        "Wie tief der sichtbare Grund liegt, in Metern: ein Bild der Tiefen von oben, Norden oben, grau oder sein Rot, oder ein Netz des Grundes, z nach oben, das liegt, wo es in der Welt liegt; jenseits davon geht der Grund in die Wassertiefe über. Die Wellen sind die der Wassertiefe und spüren ihn mit Küste",
    "From west to east of that picture; a mesh has none": "Dieses Bildes, von West nach Ost; ein Netz hat keine",
    "Where its middle is, towards +x": "Wo seine Mitte liegt, nach +x",
    "The same towards +y": "Ebenso nach +y",
    "How the energy is shared among the wavelengths": "Wie sich die Energie auf die Wellenlängen verteilt",
    "A sea as grown as its wind lets it": "Eine See, so ausgereift, wie ihr Wind es zulässt",
    "One that the wind raises over the fetch, its peak the sharper the younger it is":
        "Eine, die der Wind auf der Streichlänge aufbaut, je jünger, desto schärfer der Gipfel",
    "The same with the numbers of 1973": "Ebenso, mit den Zahlen von 1973",
    "JONSWAP in shallow water": "JONSWAP in flachem Wasser",
    "One law from the peak to ripples": "Ein Gesetz vom Gipfel bis zu den Kräuselwellen",
    "A bare tail that ends at the peak": "Ein bloßer Ausläufer, der am Gipfel endet",
    "As in Tessendorf's notes, for people who come from there": "Wie bei Tessendorf, für Leute, die von dort kommen",
    "A buoy's, of Spectrum file": "Das einer Boje, aus der Spektrumsdatei",
    "Of the wind's waves": "Der Windwellen",
    "Both are the growth law's, the peak goes with Significant height, and what the sun's glitter shows of short waves is left to the wind":
        "Beide folgen dem Wachstumsgesetz, der Gipfel geht mit der signifikanten Wellenhöhe, und was der Glitzer der Sonne von kurzen Wellen zeigt, bleibt dem Wind",
    "The height is the growth law's and the spectrum's shape gives the peak, which then keeps its place":
        "Die Höhe folgt dem Wachstumsgesetz, und die Form des Spektrums gibt den Gipfel, der dann bleibt, wo er ist",
    "Beyond a few peak wavenumbers": "Jenseits einiger Wellenzahlen des Gipfels",
    "The tail and the spreading that have the slopes of sun glitter":
        "Ausläufer und Richtungen, deren Neigungen die des Sonnenglitzers sind",
    "The spectrum's own": "Die des Spektrums",
    "Of the wind sea or the measured one, without swell. Without it: what wind, fetch and depth give":
        "Der Windsee oder der gemessenen, ohne Dünung. Ohne sie: was Wind, Streichlänge und Tiefe ergeben",
    "How it is shared among the directions": "Wie sie sich auf die Richtungen verteilt",
    "Narrowest at the peak, as measured in the North Sea": "Am Gipfel am engsten, wie in der Nordsee gemessen",
    "As measured on Lake Ontario": "Wie auf dem Ontariosee gemessen",
    "As wide for all wavelengths": "Für alle Wellenlängen gleich weit",
    "The spectrum's of this name, down to ripples": "Die des Spektrums dieses Namens, bis zu den Kräuselwellen",
    "Of long and short waves, swell too: 1, the spreadings' own; 2, about half as wide; below 1, so much of each, and the rest from all directions alike":
        "Langer und kurzer Wellen, auch der Dünung: 1, wie sie verteilt sind; 2, etwa halb so weit; unter 1, so viel davon, und der Rest aus allen Richtungen gleich",
    "How much the wind varies over the surface, in patches that drift with it: 0, not at all; 1, from calm to twice its speed. Ripples too small to be shown and foam follow; over area both stay as much":
        "Wie sehr der Wind über die Fläche schwankt, in Flecken, die mit ihm ziehen: 0, gar nicht; 1, von windstill bis zum Doppelten. Kräuselwellen, zu klein, um gezeigt zu werden, und Schaum folgen; im Ganzen bleiben beide gleich viel",
    "Of those patches; along the wind they are longer": "Dieser Flecken; entlang dem Wind sind sie länger",
    "Cat's paws and squall lines, at a place in a frame: patches of another wind that cross the sea. Ripples too small to be shown and foam follow it, waves that are shown don't. Their edges are as ragged as the pattern of Gust size":
        "Katzenpfoten und Böenlinien, in einem Bild an einem Ort: Flecken anderen Windes, die über die See ziehen. Kräuselwellen, zu klein, um gezeigt zu werden, und Schaum folgen ihm, gezeigte Wellen nicht. Ihre Ränder sind so zerfranst wie das Muster der Böengröße",
    "When it is there; it may lie between frames, and outside the range":
        "Wann sie dort ist; auch zwischen Bildern und außerhalb des Bereichs",
    "Its middle, then": "Ihre Mitte, dann",
    "Travelling towards, counter-clockwise from +x": "Wohin sie zieht, gegen den Uhrzeigersinn von +x",
    "Of its way, in the sea's seconds": "Ihres Wegs, in Sekunden der See",
    "Along its way, of the ellipse within which the wind is whole": "Entlang dem Weg, der Ellipse, in der der Wind ganz da ist",
    "Across": "Quer dazu",
    "Round the ellipse: over it the wind goes over into the sea's": "Um die Ellipse: Auf ihm geht der Wind in den der See über",
    "Times the sea's wind: more than 1 is a gust, less a lull. A calm has a tenth: the sea's long waves go on":
        "Mal den Wind der See: mehr als 1 ist eine Bö, weniger eine Flaute. Windstille hat ein Zehntel: Die langen Wellen gehen weiter",
    "On the sea: rings of its drops, which dull what the water mirrors, and a wind sea with less of its waves below a few metres, in a light wind of nearly all: 2, drizzle; 10, steady rain; 50, a cloudburst. What falls through the air isn't drawn":
        "Auf die See: Ringe der Tropfen, die das Spiegelbild stumpf machen, und eine Windsee, der Wellen unter einigen Metern fehlen, bei leichtem Wind fast alle: 2, Nieseln; 10, Landregen; 50, Wolkenbruch. Was durch die Luft fällt, wird nicht gezeichnet",
    "Waves of far storms, each a narrow spectrum of its own. Its groups come back, half as strong, after about the side of the largest tile of waves over their speed (g times the period / 4π in deep water): 446 s of a swell of 14 s by default; larger Cascades make that longer":
        "Wellen ferner Stürme, jede mit einem schmalen Spektrum für sich. Ihre Gruppen kommen wieder, halb so stark, nach etwa der Seite der größten Kachel durch ihre Geschwindigkeit (in tiefem Wasser g mal Periode / 4π): bei 14 s sonst nach 446 s; größere Kaskaden machen das länger",
    "Significant height, 4 times the root of the variance": "Signifikante Höhe, das Vierfache der Wurzel der Varianz",
    "Period of the peak": "Periode des Gipfels",
    "With Spectrum File: the densities; the files d, i, j and k lie beside it":
        "Mit dem Spektrum Datei: die Dichten; die Dateien d, i, j und k liegen daneben",
    "The path of NDBC's w file": "Der Pfad der w-Datei des NDBC",
    "With Spectrum File: one of the file's times, which are UTC": "Mit dem Spektrum Datei: eine ihrer Zeiten, in UTC",
    "A date and time with its zone, such as 2019-02-06T00:40:00Z": "Datum und Zeit mit Zeitzone, etwa 2019-02-06T00:40:00Z",
    "How waves are made": "Wie Wellen gemacht werden",
    "Tiles of waves": "Kacheln von Wellen",
    "A sum of wave trains": "Eine Summe von Wellenzügen",
    "Sharpness of the crests; 1 is the trochoid's own, 0 leaves them round, as does less than 0.0001":
        "Schärfe der Kämme; 1 ist die der Trochoide, 0 lässt sie rund, wie auch weniger als 0,0001",
    "How far the sideways displacement runs ahead of the waves in phase, with FFT: fronts are steeper than backs, and foam breaks on them; 0 is the trochoid's symmetry":
        "Wie weit die seitliche Auslenkung den Wellen in der Phase vorausläuft, mit FFT: Vorderseiten sind steiler als Rückseiten, und auf ihnen bricht Schaum; 0 ist die Symmetrie der Trochoide",
    "Of what pairs of waves add to the surface, with FFT: 1 is nature's, which raises the groups of high waves so that crests are some 10 % higher than troughs are deep; 0, as high. As the displacement, it goes with choppiness":
        "Dessen, was Wellenpaare zur Fläche beitragen, mit FFT: 1 ist das der Natur, das Gruppen hoher Wellen hebt, sodass Kämme um etwa 10 % höher sind als Täler tief; 0, gleich hoch. Wie die Auslenkung geht es mit der Zuspitzung",
    "The tiles; auto: four, from the spectrum's peak down, and none with trochoid. Their bands depend on the sizes alone; a resolution that leaves a gap is refused":
        "Die Kacheln; ohne Einträge vier, vom Gipfel des Spektrums abwärts, und keine mit Trochoide. Ihre Bänder hängen nur von den Größen ab; eine Auflösung, die eine Lücke lässt, wird abgelehnt",
    "Of the tile; all sizes differ": "Der Kachel; alle Größen sind verschieden",
    "Samples a side, even": "Stützstellen je Seite, gerade",
    "Of its waves, instead of Choppiness; with Model FFT. Waves of 0 don't break, unless all have 0":
        "Ihrer Wellen, statt der allgemeinen Zuspitzung; mit dem Modell FFT. Wellen mit 0 brechen nicht, außer wenn alle 0 haben",
    "Of the cascades": "Der Kaskaden",
    "Copies of each tile at random offsets, blended, so that no pattern is seen from the air":
        "Kopien jeder Kachel, zufällig versetzt und überblendet, sodass aus der Luft kein Muster zu sehen ist",
    "Each tile repeats after its size": "Jede Kachel wiederholt sich nach ihrer Größe",
    "Amplitudes by wavelength, on top of all else: heights, slopes and foam follow. Edges are smooth, a third of an octave wide; where bands overlap, their gains multiply":
        "Amplituden nach Wellenlänge, über allem anderen: Höhen, Neigungen und Schaum folgen. Ränder sind weich, eine drittel Oktave breit; wo Bänder sich überlagern, multiplizieren sie sich",
    "The wavelength at one edge": "Die Wellenlänge am einen Rand",
    "At the other": "Am anderen",
    "Of their amplitudes: 0 leaves them out, 2 doubles them": "Ihrer Amplituden: 0 lässt sie weg, 2 verdoppelt sie",
    "Crests that stand at a place in a frame, in the sea as it is: the sea round each, before and after it, is what such a sea most likely has round a crest of that height":
        "Kämme, die in einem Bild an einem Ort stehen, in der See, wie sie ist: Die See um jeden, davor und danach, ist, was eine solche See um einen Kamm dieser Höhe am ehesten hat",
    "When; it may lie between frames, and outside the range": "Wann; auch zwischen Bildern und außerhalb des Bereichs",
    "Where": "Wo",
    "Of the crest over the mean level; below 0, of a trough": "Des Kamms über dem mittleren Wasser; unter 0, eines Tals",
    "Calm and rough places: ellipses of the world with a soft edge, or pictures, and gains of the sea within them. Where they overlap, their gains multiply":
        "Ruhige und raue Stellen: Ellipsen der Welt mit weichem Rand, oder Bilder, und Verstärkungen der See darin. Wo sie sich überlagern, multiplizieren sie sich",
    "The middle": "Die Mitte",
    "Of the ellipse within which the gains hold whole, or of the picture":
        "Der Ellipse, in der die Verstärkungen ganz gelten, oder des Bildes",
    "Of its length, counter-clockwise from +x": "Ihrer Länge, gegen den Uhrzeigersinn von +x",
    "Round the ellipse: over it the gains fade to 1, and those of a picture across its borders and within. Waves want one of half their length":
        "Um die Ellipse: Auf ihm gehen die Verstärkungen in 1 über, die eines Bildes über seinen Grenzen und darin. Wellen wollen einen von ihrer halben Länge",
    "Of all waves' amplitudes: a lee has less than 1, a rough place more":
        "Der Amplituden aller Wellen: Eine Leeseite hat weniger als 1, eine raue Stelle mehr",
    "Of the amplitudes of short waves, whole below 25 cm and fading up to 50 cm: 0 is a slick":
        "Der Amplituden kurzer Wellen, ganz unter 25 cm und bis 50 cm nachlassend: 0 ist ein glatter Film",
    "Of what breaks, and so of what it leaves: 0 has no foam of its own":
        "Dessen, was bricht, und so dessen, was es hinterlässt: 0 hat keinen eigenen Schaum",
    "Where it holds, in place of the ellipse: a picture from above, 0 … 1, grey or the mean of its colours, whose width lies along the length. It is smoothed over the edge; beyond it nothing holds":
        "Wo sie gilt, statt der Ellipse: ein Bild von oben, 0 … 1, grau oder das Mittel seiner Farben, dessen Breite entlang der Länge liegt. Über den Rand wird es geglättet; jenseits gilt nichts",
    "The path of an .exr of 2 … 4096 pixels a side": "Der Pfad einer .exr von 2 … 4096 Pixeln je Seite",
    "What makes wakes: hulls that move, whose waves lie on the sea; they themselves aren't drawn":
        "Was Kielwasser macht: Rümpfe, die sich bewegen, deren Wellen auf der See liegen; sie selbst werden nicht gezeichnet",
    "Where its middle is: frame, east and north in metres of each key. Before the first it comes along its first course, after the last it goes on":
        "Wo seine Mitte ist: Bild, Ost und Nord in Metern jedes Punktes. Vor dem ersten kommt es auf seinem ersten Kurs, nach dem letzten fährt es weiter",
    "Frame east north, frame east north, …, of two keys or more": "Bild Ost Nord, Bild Ost Nord, …, mit zwei Punkten oder mehr",
    "Of the path between keys": "Des Pfads zwischen den Punkten",
    "Straight": "Gerade",
    "Round": "Rund",
    "Of the hull at the water": "Des Rumpfs am Wasser",
    "Its width": "Seine Breite",
    "Its depth in the water": "Seine Tiefe im Wasser",
    "Of its waves' amplitude: theory has too much of slow and of planing hulls":
        "Der Amplitude seiner Wellen: Die Theorie hat bei langsamen und gleitenden Rümpfen zu viel",
    "Of the coverage of the foam at its bow and behind its stern": "Der Bedeckung mit Schaum an seinem Bug und hinter seinem Heck",
    "With trochoid: how many, one from each bin of a geometric progression of wavelengths":
        "Mit Trochoide: wie viele, einer aus jedem Abschnitt einer geometrischen Folge von Wellenlängen",
    "With trochoid: the shortest train; what is shorter counts as variance, or is left to the cascades if there are any. Without it: 2 cm, or shorter so that ten trains are below a pixel; with cascades an eighth of the largest tile; at most a tenth of Longest":
        "Mit Trochoide: der kürzeste Zug; was kürzer ist, zählt als Varianz oder bleibt den Kaskaden. Ohne sie: 2 cm, oder kürzer, sodass zehn Züge unter einem Pixel liegen; mit Kaskaden ein Achtel der größten Kachel; höchstens ein Zehntel der Längsten",
    "With trochoid: the longest train; what is longer is not on the surface and counts as variance. Without it: all but 0.1 % of the energy is shorter; at least ten times Shortest":
        "Mit Trochoide: der längste Zug; was länger ist, fehlt der Fläche und zählt als Varianz. Ohne sie: Alle Energie bis auf 0,1 % ist kürzer; mindestens das Zehnfache der Kürzesten",
    "Whether waves feel the floor of Depth file. They come from Depth, lose height where they break, and end at the shore. With trochoid they also turn, shorten and rise, and lees fill without the pattern of diffraction; tiles (FFT) are as high as the depth lets them be, and neither turn nor shorten. Beyond the map waves are those of Depth again. There is no reflection and no run-up, and no crest overturns":
        "Ob Wellen den Grund der Tiefenkarte spüren. Sie kommen aus der Wassertiefe, verlieren Höhe, wo sie brechen, und enden am Ufer. Mit Trochoide drehen sie auch, werden kürzer und höher, und Leeseiten füllen sich ohne das Muster der Beugung; Kacheln (FFT) sind so hoch, wie die Tiefe sie lässt, und drehen nicht. Jenseits der Karte sind die Wellen wieder die der Wassertiefe. Nichts wird zurückgeworfen oder läuft auf, und kein Kamm schlägt über",
    "A square": "Ein Quadrat",
    "What the camera sees, in cells of its pixels": "Was die Kamera sieht, in Zellen aus ihren Pixeln",
    "A mesh round the camera that is fine below it and goes to the horizon with faces that stay":
        "Ein Netz um die Kamera, fein unter ihr und bis zum Horizont, dessen Flächen bleiben",
    "The limit surface of a cage": "Die Grenzfläche eines Käfigs",
    "The projected grid on a sphere that touches z = 0 at the origin":
        "Das projizierte Gitter auf einer Kugel, die z = 0 im Ursprung berührt",
    "What is baked. Pictures show the open sea to the horizon, of a planet with the camera's z as its height, unless beyond says otherwise; cages as they stand":
        "Was gebacken wird. Bilder zeigen die offene See bis zum Horizont, bei einem Planeten mit z der Kamera als Höhe, wenn Jenseits nichts anderes sagt; Käfige, wie sie stehen",
    "Side of the patch, centred on the origin, and of maps and volumes; with Near far of the finest part, below the camera":
        "Seite des Ausschnitts um den Ursprung, und von Karten und Volumen; bei Nah bis fern des feinsten Teils unter der Kamera",
    "Quads a side; with Near far of the finest part, at most 4096":
        "Vierecke je Seite; bei Nah bis fern des feinsten Teils, höchstens 4096",
    "Side of the projected grid's cells, in pictures and bakes: smaller shows finer silhouettes, and is slower":
        "Seite der Zellen des projizierten Gitters, in Bildern und Bakes: kleiner zeigt feinere Umrisse und ist langsamer",
    "Whether the projected grid, or Near far, lies on the earth's sphere: the far sea bends away, and the horizon has its dip":
        "Ob das projizierte Gitter, oder Nah bis fern, auf der Erdkugel liegt: Die ferne See krümmt sich weg, und der Horizont senkt sich",
    "With Kind Cage: the mesh whose limit surface (Catmull–Clark) the sea lies on":
        "Mit der Art Käfig: das Netz, auf dessen Grenzfläche (Catmull–Clark) die See liegt",
    "The path of a Wavefront OBJ": "Der Pfad einer Wavefront-OBJ",
    "Of a cage: how often each of its edges is halved, or adaptive: as finely as the camera sees it, in cells of Cell":
        "Eines Käfigs: wie oft jede seiner Kanten halbiert wird, oder adaptiv: so fein, wie die Kamera sie sieht, in Zellen der Größe Zelle",
    "In pictures, what lies round the patch or the cage. The other kinds reach the horizon themselves. Meshes and maps don't know it":
        "In Bildern, was um den Ausschnitt oder den Käfig liegt. Die anderen Arten reichen selbst bis zum Horizont. Netze und Karten kennen es nicht",
    "The sea for a patch and nothing for a cage": "Die See bei einem Ausschnitt, nichts bei einem Käfig",
    "The open sea to the horizon, at z = 0": "Die offene See bis zum Horizont, bei z = 0",
    "The sky is behind it": "Der Himmel ist dahinter",
    "Of pictures on a screen: so many stops brighter; EXRs hold the light itself":
        "Von Bildern auf einem Schirm: um so viele Blenden heller; EXRs enthalten das Licht selbst",
    "The exposure that a photographer's meter shows at ISO 100: 15 in full sun, 12 at sunset, 5 in deep dusk. Without it the shot's views are metered":
        "Die Belichtung, die ein Belichtungsmesser bei ISO 100 zeigt: 15 in voller Sonne, 12 bei Sonnenuntergang, 5 in tiefer Dämmerung. Ohne sie werden die Ansichten der Aufnahme gemessen",
    "Of the sun's middle above the horizon: the true (geometric) one, which is also where it's seen, since the air here refracts nothing; real air shows a setting sun half a degree higher":
        "Der Sonnenmitte über dem Horizont: die wahre (geometrische), wo sie hier auch steht, denn diese Luft bricht kein Licht; wirkliche hebt eine untergehende Sonne um ein halbes Grad",
    "pixels": "Pixel", "stops": "Blenden",
    "Towards the sun, counter-clockwise from +x (east)": "Zur Sonne hin, gegen den Uhrzeigersinn von +x (Osten)",
    "Clear daylight, or a picture of a sky: lat-long, middle column +x, azimuth growing to the left, top row the zenith; its sun is found in it":
        "Klares Tageslicht, oder das Bild eines Himmels: Länge und Breite, mittlere Spalte +x, Azimut wächst nach links, oberste Zeile der Zenit; seine Sonne wird darin gefunden",
    "daylight, or the path of an .exr": "daylight, oder der Pfad einer .exr",
    "none, or the path of an .exr or .obj": "none, oder der Pfad einer .exr oder .obj",
    "Haze of the daylight's air; 2 is the open sea's, 3 land's, 6 is hazy":
        "Dunst der Luft bei Tageslicht; 2 ist offene See, 3 Land, 6 ist diesig",
    "With a picture of a sky: how far one sees through its air; without it the air is clear":
        "Mit dem Bild eines Himmels: wie weit man durch seine Luft sieht; ohne sie ist die Luft klar",
    "Turns a picture of a sky and its sun, counter-clockwise from above":
        "Dreht das Bild eines Himmels und seine Sonne, von oben gegen den Uhrzeigersinn",
    "Multiplies the radiance of a picture of a sky and its sun": "Multipliziert das Licht im Bild eines Himmels und seiner Sonne",
    "What the water holds besides plankton": "Was das Wasser außer Plankton enthält",
    "Some silt": "Etwas Schlick",
    "Much of it": "Viel davon",
    "The clearest of Jerlov's types of the open sea": "Die klarste von Jerlovs Arten der offenen See",
    "The murkiest of them": "Die trübste davon",
    "The clearest of his types of coasts": "Die klarste seiner Arten der Küsten",
    "Plankton: greens the water": "Plankton: macht das Wasser grün",
    "Light in the water by the ways of sun and eye, with the floor at Depth; off: one colour for the whole sea":
        "Licht im Wasser nach den Wegen von Sonne und Auge, mit dem Grund in der Wassertiefe; aus: eine Farbe für die ganze See",
    "What the floor reflects: red, green, blue; pale sand, 0.36, 0.31, 0.23":
        "Was der Grund zurückwirft: Rot, Grün, Blau; heller Sand, 0,36, 0,31, 0,23",
    "What the floor looks like near, times its colour: plain, or a picture that tiles, its top to the north":
        "Wie der Grund aus der Nähe aussieht, mal seine Farbe: einfarbig, oder ein Bild, das sich kacheln lässt, oben nach Norden",
    "plain, or the path of an .exr, square, with a side of 1, 2 ... 1024 pixels":
        "plain, oder der Pfad einer .exr, quadratisch, mit einer Seite von 1, 2 ... 1024 Pixeln",
    "The side of that picture on the floor": "Die Seite dieses Bildes auf dem Grund",
    "How much waves shape the light in the water: a low sun shines through crests, and their far sides are dark; 1 is as computed, 0 none":
        "Wie sehr Wellen das Licht im Wasser formen: Eine tiefe Sonne scheint durch Kämme, und ihre fernen Seiten sind dunkel; 1 wie berechnet, 0 gar nicht",
    "How much the bubbles under foam brighten the water; 1 is as computed, 0 none":
        "Wie sehr die Blasen unter Schaum das Wasser aufhellen; 1 wie berechnet, 0 gar nicht",
    "How much waves gather the sun's light, on a floor that is seen and in shafts under water; 1 is as computed, 0 even light":
        "Wie sehr Wellen das Sonnenlicht bündeln, auf sichtbarem Grund und in Strahlen unter Wasser; 1 wie berechnet, 0 gleichmäßiges Licht",
    "Foam where waves break; off, no output has coverage and none is computed":
        "Schaum, wo Wellen brechen; aus, enthält keine Ausgabe welchen, und keiner wird berechnet",
    "How much foam a wind makes": "Wie viel Schaum ein Wind macht",
    "Much in storms": "Viel in Stürmen",
    "Goes with Sea warmer than air as well": "Geht auch nach der Wärme der See gegen die Luft",
    "Stays at 8 % beyond 23 m/s": "Bleibt über 23 m/s bei 8 %",
    "With Monahan 1986: how much warmer the sea is than the air; a warm one foams more":
        "Mit Monahan 1986: um wie viel die See wärmer ist als die Luft; eine warme schäumt mehr",
    "Times the law's foam; 0: none": "Mal den Schaum des Gesetzes; 0: keiner",
    "The shortest waves that break; 0: ripples break as well, and foam is a veil":
        "Die kürzesten Wellen, die brechen; 0: Auch Kräuselwellen brechen, und Schaum ist ein Schleier",
    "How long the foam that breaking leaves lives, to 1/e of it; 0: foam only where waves break now":
        "Wie lange der Schaum lebt, den Brecher hinterlassen, bis auf 1/e; 0: Schaum nur, wo jetzt Wellen brechen",
    "How fast the wind carries that foam along, as a share of its speed":
        "Wie schnell der Wind diesen Schaum mitträgt, als Anteil seiner Geschwindigkeit",
    "In pictures: 0 shows foam as smooth coverage, 1 as holes and lace; its mean is the same":
        "In Bildern: 0 zeigt Schaum als glatte Bedeckung, 1 als Löcher und Spitze; sein Mittel ist gleich",
    "How far a wind of 15 m/s draws that lace out along it; less blows less, a storm twice as far":
        "Wie weit ein Wind von 15 m/s diese Spitze in die Länge zieht; weniger weniger, ein Sturm doppelt so weit",
    "What foam looks like near: lace, or a picture that tiles, brightest where foam is thickest, the wind blowing to its right; its mean is the same":
        "Wie Schaum aus der Nähe aussieht: Spitze, oder ein Bild, das sich kacheln lässt, am hellsten, wo Schaum am dicksten ist, der Wind weht nach rechts; sein Mittel ist gleich",
    "lace, or the path of an .exr, square, with a side of 16, 32 ... 4096 pixels":
        "lace, oder der Pfad einer .exr, quadratisch, mit einer Seite von 16, 32 ... 4096 Pixeln",
    "The side of that picture on the water": "Die Seite dieses Bildes auf dem Wasser",
    "What foam reflects where waves break, as far as it hides the water; 0.55 is measured (Whitlock 1982)":
        "Was Schaum zurückwirft, wo Wellen brechen, soweit er das Wasser verdeckt; 0,55 ist gemessen (Whitlock 1982)",
    "The same for the foam that breaking has left": "Ebenso für den Schaum, den Brecher hinterlassen haben",
    "The share of its area that foam hides where waves break; 0: such that the mean over all foam is 0.4, which is measured (Koepke 1984)":
        "Der Anteil seiner Fläche, den Schaum verdeckt, wo Wellen brechen; 0: so, dass das Mittel über allen Schaum 0,4 ist, was gemessen ist (Koepke 1984)",
    "Droplets over breaking crests; none without whitecaps": "Tröpfchen über brechenden Kämmen; keine ohne Schaumkronen",
    "How much spray a wind makes": "Wie viel Gischt ein Wind macht",
    "Drops torn off crests, seen in a gale": "Tropfen, von Kämmen gerissen, in stürmischem Wind zu sehen",
    "The bubbles' alone, too thin to be seen": "Nur die der Blasen, zu dünn, um gesehen zu werden",
    "How much spray there is; 1 is the law's": "Wie viel Gischt es gibt; 1 ist die des Gesetzes",
    "The large drops of that spray as particles that fly off crests: in pictures, near the camera, in Blender and in Drops; volumes hold the rest. Only by Andreas 1998":
        "Die großen Tropfen dieser Gischt als Partikel, die von Kämmen fliegen: in Bildern, nahe der Kamera, in Blender und in Tropfen; Volumen enthalten den Rest. Nur mit Andreas 1998",
    "How much time accuracy may take": "Wie viel Zeit Genauigkeit kosten darf",
    "For finding the view": "Zum Suchen der Ansicht",
    "Finer": "Feiner",
    "For pictures that move": "Für Bilder, die sich bewegen",
    "What the others are compared with": "Womit die anderen verglichen werden",
    "Instead of level: the cheapest settings that hold it. Of a mesh, the distance from the sea over the significant height (RMS); of pictures, the relative error of radiance that 95 % of the water's pixels don't exceed":
        "Statt der Stufe: die billigsten Einstellungen, die ihn einhalten. Bei einem Netz der Abstand von der See durch die signifikante Höhe (RMS); bei Bildern der relative Fehler des Lichts, den 95 % der Pixel des Wassers nicht überschreiten",
    "Instead of level: the most accurate settings that compute a frame of a run in this time: of files on the machine that begins them (pelagic calibrate), in Blender on two recorded cores":
        "Statt der Stufe: die genauesten Einstellungen, die ein Bild einer Folge in dieser Zeit berechnen: bei Dateien auf dem Rechner, der sie beginnt (pelagic calibrate), in Blender auf zwei aufgezeichneten Kernen",
    "How the mesh is written": "Wie das Netz geschrieben wird",
    "As text": "Als Text",
    "As binary crates": "Als binäre Crates",
    "Not": "Gar nicht",
    "What the mesh carries per vertex. Velocities are the waves' orbital ones, by linear theory: no Stokes drift is in them":
        "Was das Netz je Punkt mitführt. Geschwindigkeiten sind die der Bahnbewegung linearer Wellen, ohne Stokes-Drift",
    "Images over the patch, a file a frame": "Bilder des Ausschnitts, eine Datei je Bild",
    "Of the maps, a side": "Der Karten, je Seite",
    "Each cascade's own periodic tile as well": "Auch die periodische Kachel jeder Kaskade",
    "What the mesh is": "Was das Netz ist",
    "Every vertex lies on the sea": "Jeder Punkt liegt auf der See",
    "Of a patch, a cage whose limit surface is the sea, without normals":
        "Eines Ausschnitts, ein Käfig, dessen Grenzfläche die See ist, ohne Normalen",
    "OpenVDB files over the patch's square, one a frame: spray, and the sea as a level set":
        "OpenVDB-Dateien über dem Quadrat des Ausschnitts, eine je Bild: Gischt, und die See als Level-Set",
    "Side of the volumes' voxels": "Seite der Voxel der Volumen",
    "USD points over the patch's square, a file a frame: the particles of Spray drops":
        "USD-Punkte über dem Quadrat des Ausschnitts, eine Datei je Bild: die Partikel der Gischttropfen",
    "{} to {}": "{} bis {}",
    "{} or more": "{} oder mehr",
    "Whether {} is given; otherwise it is chosen": "Ob {} angegeben ist; sonst wird sie gewählt",
    "Whether {} is finite; otherwise it is infinite": "Ob {} endlich ist; sonst ist sie unendlich",
    "Whether {} is a number; otherwise it is adaptive": "Ob {} eine Zahl ist; sonst ist sie adaptiv",
    # What panels say
    "Wind": "Wind", "Seas": "Seegänge", "Your own": "Eigene", "automatic": "selbsttätig", "infinite": "unendlich",
    "0 Calm": "0 Windstille", "1 Light air": "1 Leiser Zug", "2 Light breeze": "2 Leichte Brise", "3 Gentle breeze": "3 Schwache Brise",
    "4 Moderate breeze": "4 Mäßige Brise", "5 Fresh breeze": "5 Frische Brise", "6 Strong breeze": "6 Starker Wind",
    "7 Near gale": "7 Steifer Wind", "8 Gale": "8 Stürmischer Wind", "9 Strong gale": "9 Sturm", "10 Storm": "10 Schwerer Sturm",
    "11 Violent storm": "11 Orkanartiger Sturm", "12 Hurricane": "12 Orkan",
    "Building the sea…": "Die See entsteht …", "Waves of {} m; foam follows…": "Wellen von {} m; der Schaum folgt …", "There is no ocean in this scene": "In dieser Szene ist kein Ozean",
    "The scene's sun and sky are those of {}, its first ocean by name. What is set here counts in this ocean's own shots and bakes":
        "Sonne und Himmel der Szene sind die von {}, dem Namen nach ihrem ersten Ozean. Was hier steht, gilt in den Aufnahmen und Bakes dieses Ozeans",
    "The object's own mesh": "Das eigene Netz des Objekts",
    "Waves of {} m (significant height)": "Signifikante Wellenhöhe {} m",
    "Clear down to {:.0f} m": "Klar bis {:.0f} m Tiefe", "Clear down to {:.1f} m": "Klar bis {:.1f} m Tiefe",
    "The camera is under water. Where the surface comes close, the camera's Clip Start cuts it away: 0.01 m leaves it there":
        "Die Kamera ist unter Wasser. Wo die Oberfläche nahe kommt, schneidet der Anfang des Sichtbereichs sie weg: 0.01 m lassen sie stehen",
    "The camera is under water: for Cycles it is a volume. EEVEE shows it without caustics or shadows":
        "Die Kamera ist unter Wasser: Für Cycles ist es ein Volumen. EEVEE zeigt es ohne Kaustik und Schatten",
    "The floor is too deep to show: the water is opaque in Cycles":
        "Der Grund liegt zu tief, um zu sehen zu sein: In Cycles ist das Wasser undurchsichtig",
    "The floor gives the water its colour. A patch to the horizon would show the floor itself":
        "Der Grund färbt das Wasser. Ein Ausschnitt bis zum Horizont würde ihn selbst zeigen",
    "The floor is near enough to show: for Cycles the water is a volume, which takes longer":
        "Der Grund liegt so nah, dass er zu sehen ist: Für Cycles ist das Wasser ein Volumen, was länger dauert",
    "Shots have no objects: select some, and choose Object, Pelagic, Add to Sea":
        "Aufnahmen haben keine Objekte: wähle welche aus und dann Objekt, Pelagic, In die See setzen",
    "In the sea's light it floats as in a shot: by its own size, in its place":
        "Im Licht der See schwimmt es wie in einer Aufnahme: nach seiner eigenen Größe, an seinem Platz",
    "Vertices: {}": "Punkte: {}", "Viewport: {} of {} vertices": "Ansicht: {} von {} Punkten",
    "Waiting: a view in Rendered or Wireframe shows the mesh": "Wartet: eine Ansicht als Rendering oder Drahtgitter zeigt das Netz",
    "The view is under water, which can't be drawn: raise it":
        "Die Ansicht ist unter Wasser, was sich nicht zeichnen lässt: sie muss höher",
    "The program pelagic isn't in the PATH: a job is the shot then, and the command that goes on is copied":
        "Das Programm pelagic ist nicht im PATH: ein Auftrag ist dann die Aufnahme, und der Befehl, mit dem es weitergeht, wird kopiert",
    "This ocean was made by a newer Pelagic: what is new in it is missing here":
        "Diesen Ozean hat ein neueres Pelagic gemacht: was darin neu ist, fehlt hier",
}
TABLES = {"de": GERMAN}
CONTEXT = "Pelagic"  # of what say() says, where Blender's own German is of another thing


def base(label):
    """A label without its unit, and the unit in brackets."""
    return re.fullmatch(r"(.*?)((?: \([^()]*\))?)", label).groups()


def _whole(words):
    """The table, with labels and tooltips of keys as properties have them: put together of its words."""
    def said(text):
        return words.get(text, text)

    made = dict(words)
    for field in (each for field in FIELDS for each in (field, *entry_fields(field))):
        label, unit = base(label_of(field.key))
        made |= {label + unit: words[label] + unit} if label in words else {}
        made[tooltip(field.key)] = tooltip(field.key, said)
        made |= {switch_tooltip(field): switch_tooltip(field, said)} if field.switch else {}
    return made


def say(text, *values):
    """A label, or a sentence with its numbers and names, in the language of the interface."""
    said = bpy.app.translations.pgettext_iface(text, CONTEXT)
    return said.format(*values) if values else said  # what the core says may have braces


def register():
    bpy.app.translations.register(__package__, {
        language: {(context, text): said for text, said in _whole(words).items() for context in ("*", "Operator", CONTEXT)}
        for language, words in TABLES.items()})


def unregister():
    bpy.app.translations.unregister(__package__)
