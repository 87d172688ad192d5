# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on in other languages: labels, names of operators and their tooltips, what panels say. Where Blender
knows a word itself its own comes first, but for the labels of keys. What keys accept, and what the core says of a shot, is English.

Another language is another table. Words in braces are numbers or names, and stay.
"""

import re

import bpy

from .properties import FIELDS, entry_fields, label_of

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
    "Wind speed": "Windgeschwindigkeit", "Wind direction": "Windrichtung", "Fetch": "Streichlänge", "Depth": "Wassertiefe",
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
    "Draw the sea in solid and material views as it is lit, to the horizon, and hide its mesh; or stop that":
        "Die See in Ansichten beleuchtet bis zum Horizont zeichnen und ihr Netz verbergen; oder damit aufhören",
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
CONTEXT = "Pelagic"  # of what say() says: Blender's own German for a fetch is "Holen"


def base(label):
    """A label without its unit, and the unit in brackets."""
    return re.fullmatch(r"(.*?)((?: \([^()]*\))?)", label).groups()


def _with_units(words):
    """The table, with the keys' labels as properties have them."""
    labels = [label_of(key) for field in FIELDS for key in (field.key, *(inner.key for inner in entry_fields(field)))]
    return words | {label: words[base(label)[0]] + base(label)[1] for label in labels if base(label)[0] in words}


def say(text, *values):
    """A label, or a sentence with its numbers and names, in the language of the interface."""
    said = bpy.app.translations.pgettext_iface(text, CONTEXT)
    return said.format(*values) if values else said  # what the core says may have braces


def register():
    bpy.app.translations.register(__package__, {
        language: {(context, text): said for text, said in _with_units(words).items() for context in ("*", "Operator", CONTEXT)}
        for language, words in TABLES.items()})


def unregister():
    bpy.app.translations.unregister(__package__)
