"""French, Spanish and Italian vocabulary, in the format of ``english.py``; words have no accents."""

ROMANCE: dict[str, str] = {
    # French
    "turn": "virage | tournant | courbe | curva | viraje | giro | svolta",
    "turn+": "virages | tournants | courbes | curvas | virajes | giros | svolte",
    "turn~": "tourne | gira | dobla",
    "straight": "ligne droite | tout droit | droite ligne | rectiligne | recta | recto | rettilineo"
    " | rettilinea | dritto | dritta | todo recto | tramo recto | una recta | linea recta",
    "straight+": "lignes droites | rectas | rettilinei",
    "hairpin": "epingle | epingle a cheveux | virage en epingle | horquilla | curva de horquilla | tornante",
    "hairpin+": "epingles | epingles a cheveux | virages en epingle | horquillas | tornanti",
    "serpentine": "lacets | en lacets | serpentinas | serpentin",
    "winding": "sinueuse | sinueux | sinuosa | tortuosa | tortueuse",
    "zigzag": "en zigzag",
    "s_bend": "virage en s | curva en s | curva a s",
    "u_turn": "demi tour | media vuelta | inversione a u",
    "crest": "bosse | colina | dosso | sommet",
    "dip": "creux | cunetta",
    "left": "gauche | a gauche | izquierda | a la izquierda | hacia la izquierda | sinistra"
    " | a sinistra | vers la gauche",
    "right": "droite | a droite | derecha | a la derecha | hacia la derecha | destra | a destra"
    " | vers la droite",
    "gentle": "doux | douce | leger | legere | suave | suaves | dolce | dolci | leggera | legers"
    " | legeres | larghe",
    "sharp": "serre | serree | serres | serrees | cerrada | cerradas | stretta | strette | brusque | cerrado",
    "sweeping": "ample | amplia | amplias | ampia | ampie",
    "long": "longue | larga | largo | lunga | lungo",
    "short": "court | courte | corta | corto | breve",
    "up": "en montee | cuesta arriba | in salita | vers le haut",
    "up~": "montee | monte | montant | montante | grimpe | subida | sube | ascendente | salita"
    " | sale | che sale | qui monte | que sube",
    "down": "en descente | cuesta abajo | in discesa | vers le bas",
    "down~": "descente | descendant | descendante | descend | bajada | baja | descendente | discesa"
    " | scende | qui descend | que baja | che scende",
    "flat": "plat | plate | plats | llana | llano | plana | plano | piana | piano | pianeggiante",
    "nearly": "presque | casi | quasi",
    "steep": "raide | empinada | empinado | ripida | ripido",
    "mountain": "montagne | montana | montagna | de montagne | de montana | di montagna",
    "#2": "deux | dos | due",
    "#3": "trois | tres | tre",
    "#4": "quatre | cuatro | quattro",
    "#5": "cinq | cinco | cinque",
    "#6": "seis | sei",
    "#7": "sept | siete | sette",
    "#8": "huit | ocho | otto",
    "#9": "neuf | nueve | nove",
    "#10": "dix | diez | dieci",
    "#100": "cent | cien | cento",
    "#3+": "plusieurs | varias | varios | diverse | parecchie",
    ">=": "au moins | por lo menos | al menos | almeno",
    "<=": "au plus | como maximo | al massimo",
    "m": "metros | metri | metro",
    "%": "pour cent | por ciento | per cento | pourcent",
    "deg": "degres | grados | gradi | degre",
    "and": "et | y | e",
    "or": "ou | o",
    "then": "puis | ensuite | suivi de | suivie de | luego | despues | seguido de | seguida de"
    " | seguida por | poi | seguita da | seguito da | dopo",
    "with": "avec | con | qui a",
    "first_of_all": "d'abord | primero | prima",
    "start": "commence par | commencant par | empieza con | comienza con | inizia con",
    "end": "finit par | se termine par | terminant par | termina con | finisce con | terminando con"
    " | enfin | finalmente | terminando en",
    "a": "un | une | una | uno",
    "the": "le | la | les | el | los | las | il | lo | gli | l'",
    "no": "sans | sin | senza",
    "all": "tous | toutes | todos | todas | tutte | tutti",
    "alternating": "alternes | alternees | alternados | alternadas | alternate",
    "road": "route | carretera | camino | strada | rue | chemin | carrera | via",
    "-": "de | du | des | d'une | d'un | en | qui | que | che | di | da | del | della | vers | au"
    " | aux | dans | por | par | per | se | su | sur | pour | va | avec une | es | est | tiene"
    " | ha | hacia | verso | fait | une seule | al",
}
