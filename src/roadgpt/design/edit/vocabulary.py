"""The vocabulary of change requests: phrases, written without accents, and their meanings.

A phrase of several words takes precedence over its parts. A meaning that contains blanks is a sequence of
several meanings. The five languages share one table, as few of their words coincide; for those that do,
English takes precedence.
"""

NUMBERS = {
    1: "one uno una ein eine einen einer",
    2: "two zwei deux dos due",
    3: "three drei trois tres tre",
    4: "four vier quatre cuatro quattro",
    5: "five funf cinq cinco cinque",
    6: "six sechs seis sei",
    7: "seven sieben sept siete sette",
    8: "eight acht huit ocho otto",
    9: "nine neun neuf nueve nove",
    10: "ten zehn dix diez dieci",
    20: "twenty zwanzig vingt veinte venti",
    30: "thirty dreissig trente treinta trenta",
    50: "fifty funfzig cinquante cincuenta cinquanta",
    90: "ninety neunzig",
    100: "hundred hundert cent cien cento",
}
ORDINALS = {
    1: "first erste ersten erster erstes premier premiere primera primero primer primo prima",
    2: "second zweite zweiten zweiter zweites deuxieme seconde segunda segundo seconda secondo",
    3: "third dritte dritten dritter drittes troisieme tercera tercero tercer terza terzo",
    4: "fourth vierte vierten vierter viertes quatrieme cuarta cuarto quarta quarto",
    5: "fifth funfte funften cinquieme quinta quinto",
    6: "sixth sechste sechsten sixieme sexta sexto sesta sesto",
    7: "seventh siebte siebten septieme septima septimo settima settimo",
    8: "eighth achte achten huitieme octava octavo ottava ottavo",
    9: "ninth neunte neunten neuvieme novena noveno nona nono",
    10: "tenth zehnte zehnten dixieme decima decimo",
    11: "eleventh", 12: "twelfth", 13: "thirteenth", 14: "fourteenth", 15: "fifteenth",
    -1: "last final letzte letzten letzter letztes dernier derniere ultima ultimo",
    -2: "penultimate vorletzte vorletzten penultima penultimo | avant derniere | avant dernier"
    " | second to last | second last | last but one | next to last | one before last",
}  # fmt: skip

# Meaning: phrases, between bars; words between blanks stand alone.
WORDS: dict[str, str] = {
    # things on the road
    "turn": "turn turns bend bends curve curves corner corners kurve kurven kehre kehren virage virages"
    " tournant tournants courbe courbes curva curvas curve svolta svolte biegung kink kinks dogleg doglegs"
    " elbow",
    "sweeping turn": "sweeper sweepers",
    "turn after": "| the one after | the one following",
    "turn before": "| the one before",
    "straight before": "approach | approach to | run up to | lead in to | zufahrt zu",
    "hairpin": "hairpin hairpins switchback switchbacks haarnadelkurve haarnadelkurven haarnadel spitzkehre"
    " spitzkehren horquilla horquillas tornante tornanti | hairpin bend | hairpin turn | hairpin bends"
    " | hairpin turns | hair pin | epingle | epingles | epingle a cheveux | en epingle | curva de horquilla"
    " | curva a gomito",
    "u_turn": "uturn | u turn |  u turns",
    "s_bend": "s bend | s curve | s kurve",
    "chicane": "chicane chicanes schikane chicana",
    "straight": "straight straights straightaway gerade geraden geradeaus recta rectas rettilineo"
    " rettilinei rettifilo | straight road | straight bit | straight line | straight section"
    " | straight stretch | straight part | straight piece | ligne droite | tout droit | lignes droites"
    " | tramo recto | tratto dritto",
    "road": "road track route strasse strecke carretera strada camino percorso ruta circuit everything"
    " overall"
    " | whole road | entire road | whole thing | ganze strasse | ganze strecke | toute la route"
    " | toda la carretera | tutta la strada | the lot",
    "end": "end ending finish ende schluss fin final finale fine | last part | last section | last bit"
    " | last stretch | final section | final part | final stretch | ultimo tramo | tramo final | dernier"
    " troncon | ultimo tratto | tratto finale | closing section | letzte stuck | very end | tail end |"
    " road's end"
    " | end of the road | end of road | end of the track",
    "start": "start beginning anfang beginn debut depart inicio comienzo principio inizio | first part"
    " | first section | first bit | first stretch | primer tramo | tramo inicial | premier troncon | primo"
    " tratto | tratto iniziale | start of the road | beginning of the road | opening | road's start",
    "it": "it them they this that these those sie ihn",
    "half1": "| first half | erste halfte | ersten halfte | premiere moitie | primera mitad | prima meta",
    "half2": "| second half | last half | zweite halfte | zweiten halfte | deuxieme moitie | seconde moitie"
    " | segunda mitad | seconda meta",
    "radius": "radius rayon radio raggio radii",
    "angle_noun": "sharpness tightness curvature severity angle winkel angulo angolo",
    "length_noun": "length lange longueur longitud lunghezza",
    "slope_noun": "steepness slope grade gradient incline inclination steigung gefalle neigung pente"
    " pendiente"
    " pendenza",
    "side_noun": "side sides direction directions hand seite seiten richtung cote lado lato direzione sens",
    # which of them
    "a": "a an another un une einem ein eine einen eines una uno | one more | an extra | an additional"
    " | a new | eine weitere | eine neue | noch eine | another one | a further | some extra | some more |"
    " un autre | une autre | otra | otro"
    " | un altra | un altro",
    "the": "the der die das den dem des el los las il gli i l la le les lo its their",
    "every": "every each all both jede jeden jedes alle allen beide beiden chaque tous toutes todas todos"
    " cada tutte tutti ogni | all the | all of the | each of the | every one of the | both of the"
    " | toutes les | tous les | todas las | todos los | tutte le | tutti i",
    "left": "left links linke linken linker linkes gauche izquierda izquierdo sinistra lefthand leftward"
    " leftwards lefthander | to the left | left hand | on the left | nach links | a gauche"
    " | a la izquierda | a sinistra",
    "right": "right rechts rechte rechten rechter rechtes droite derecha derecho destra righthand rightward"
    " rightwards righthander | to the right | right hand | on the right | nach rechts"
    " | a droite | a la derecha | a destra",
    "lefts": "lefts lefthanders | left handers",
    "rights": "rights righthanders | right handers",
    "left turn": "linkskurve linkskurven | left hander",
    "right turn": "rechtskurve rechtskurven | right hander",
    "mid": "middle central centre center mittlere mittleren mitte milieu medio mezzo centrale",
    "sharpest": "sharpest tightest hardest scharfste scharfsten engste engsten | most severe"
    " | le plus serre | la plus serree",
    "gentlest": "gentlest softest widest easiest sanfteste weiteste weitesten",
    "longest": "longest langste langsten | la plus longue | le plus long | mas larga de todas",
    "shortest": "shortest kurzeste kurzesten",
    "steepest": "steepest steilste steilsten",
    "flattest": "flattest flachste flachsten",
    "instead": "| instead of | rather than | in place of | anstatt | statt | anstelle von | au lieu de | au"
    " lieu d"
    " | au lieu du | plutot que | en vez de | en vez del | en lugar de | invece di | invece che | invece del"
    " | al posto di",
    "at_most": "cap limit clamp maximum max under below | at most | a maximum of | cap at | limit to |"
    " hochstens"
    " | maximal | au plus | como maximo | al massimo",
    "at_least": "minimum min | at least | a minimum of | mindestens | au moins | al menos | almeno",
    "from": "from",
    "follow": "follow follows followed precede precedes preceded",
    "separate": "separate separated trenne separe separa",
    "over": "over above beyond exceeding",
    "smallest": "smallest least kleinsten kleinste",
    "largest": "largest biggest greatest highest grossten grosste",
    "quarter": "quarter viertel",
    "plus": "+",
    "is": "is are ist sind est sont es son",
    "alternate": "alternate alternating alternately abwechselnd alterner alterne alternar alterna",
    "but": "except excluding | except for | apart from | other than | all but | ausser | sauf | excepto"
    " | menos | tranne",
    "straight between": "| distance between | gap between | space between | spacing between",
    # what to do
    "keep": "keep keeps kept leave leaves unchanged untouched unaltered alone lass behalte | as it is"
    " | as they are | as is",
    "make": "replace replaced make makes let set change turn put have give convert shift adjust modify"
    " edit mach mache machen"
    " lass andere bump crank push bring mets rends fais rendre rend faire haz pon haga hacer cambia fai"
    " rendi metti soll sollen"
    " become becomes | dial back | dial up | bring down | bring up | ramp up | swap out | switch out",
    "add": "add insert append include attach place tack stick slot squeeze throw hinzu fuge hange einfugen"
    " hinzufugen ajoute ajouter"
    " ajoutez insere inserer anade anadir agrega agregar aggiungi aggiungere inserisci | squeeze in | throw"
    " in | fit in | slot in | drop in | work in | stick in | add in | build in | put in"
    " | bau ein | fuge hinzu",
    "add at_end": "| end in | ends in | end the road with | finish the road with | end with | ends with"
    " | ending with | finish with | finishes with | finish on | end on | end off with | terminate with",
    "add at_start": "| start the road with | begin the road with | start with | starts with | begin with"
    " | begins with",
    "remove": "take shave knock kill ditch lose dump discard remove delete drop cut erase eliminate scrap"
    " omit skip entferne entfernen losche loschen"
    " streiche supprime supprimer enleve enlever retire quita quitar elimina eliminar borra rimuovi togli"
    " cancella eliminare weg | take out | take away | leave out | get rid of | cut out | lass weg"
    " | do away with",
    "swap": "swap flip reverse switch invert vertausche wechsle inverse inverser invierte inverti"
    " umdrehen | other way | the other way | other side | other direction | opposite side"
    " | opposite direction | opposite way | the other way round | change the side | change sides"
    " | andere richtung | andere seite | autre cote | otro lado | altro lato",
    "mirror": "mirror mirrored mirrors spiegel spiegle spiegeln gespiegelt miroir symetrique refleja"
    " espeja specchia specchiare",
    "straighten": "straighten | straighten out | begradige | begradigen | redresse | endereza | raddrizza",
    "too": "too trop demasiado troppo",
    "not": "not don't dont never no nicht kein keine keinen ne pas jamais nunca non if unless wenn falls si"
    " cannot doesn't shouldn't or oder ou either without ohne sans sin senza"
    " than",
    # how
    "sharper": "sharper verscharfe verscharfen accentue accentua acentua sharpen harder scharfer | more"
    " sharp | more acute | plus prononce | plus prononcee"
    " | mas pronunciada | more pronounced | sharper angle | plus fort | piu accentuata | more severe",
    "gentler": "gentler relax loosen adoucis adoucir suaviza suavizar addolcisci addolcire entscharfe"
    " entscharfen softer smoother easier soften ease smooth open sanfter weicher | more gentle"
    " | open up | opened up | opening up | less sharp | less tight | less severe | plus doux | plus douce |"
    " mas suave | piu dolce"
    " | less pronounced | weniger scharf | moins serre | moins serree | menos cerrada | meno stretta",
    "tighter": "tighter resserre resserrer stringi restringi cierra tighten narrower enger | more tight |"
    " less wide | less open | less sweeping |"
    " plus serre | plus serree | plus serres"
    " | plus serrees | mas cerrada | mas cerradas | mas cerrado | piu stretta | piu stretto | piu strette",
    "wider": "wider elargis elargir allarga allargare abre ensancha erweitere widen broader opener weiter |"
    " more open | more sweeping | plus large | plus ouvert"
    " | mas abierta | mas ancha | piu ampia | piu larga",
    "sharp": "sharp accentuata accentuato prononce prononcee pronunciada pronunciado pronounced severe"
    " tight hard acute scharf scharfe scharfen enge serre serree cerrada stretta",
    "gentle": "gentle soft easy slight mild sanft sanfte sanften leichte doux douce suave dolce",
    "sweeping": "sweeping wide broad weite ample large ampia",
    "longer": "longer lengthen extend stretch prolong elongate verlangere verlangern langer allonge"
    " allonger"
    " rallonge alarga alargar prolonga allunga allungare | more long | plus long | plus longue"
    " | plus longues | mas larga | mas largo | mas larga | piu lungo | piu lunga | plus longs",
    "shorter": "shorter shorten shrink trim kurzer verkurze verkurzen kurze raccourcis raccourcir acorta"
    " acortar accorcia accorciare | less long | plus court | plus courte | mas corta | mas corto"
    " | piu corto | piu corta | piu breve",
    "long": "long lang lange langen longue larga largo lunga lungo",
    "short": "short kurz kurzen court courte corta corto corta breve",
    "steeper": "steeper steepen steiler | more steep | plus raide | plus raides | plus pentu | plus pentue"
    " | mas empinada | mas empinado | mas inclinada | piu ripida | piu ripido | steeper slope"
    " | more inclined",
    "flatter": "flatter shallower flacher | less steep | less inclined | weniger steil | plus plat"
    " | plus plate | moins raide | mas llana | mas plana | menos empinada | piu piano | meno ripida"
    " | meno ripido | piu pianeggiante | more level | more flat",
    "flat": "flat aplana aplanar nivela aplanis aplatis spiana spianare ebne level even flatten horizontal"
    " eben ebene flach flache plat plate llana llano plana plano"
    " pianeggiante piatto piatta waagerecht | level out | de niveau | in piano | without slope | no slope",
    "up": "up suba sube subir salga salire monter monte steige steigen steigt uphill climb climbs climbing"
    " rise rises rising ascend ascending upward upwards ascent bergauf"
    " aufwarts ansteigend steigend montee montant montante salita subida ascendente | go up | goes up"
    " | going up | en montee | qui monte | cuesta arriba | in salita | hacia arriba | uphill slope"
    " | bergauf gehen",
    "down": "down baje baja bajar scenda scende scendere descende descendre descends falle fallt downhill"
    " descend descends descending falling fall falls downward downwards descent"
    " bergab abwarts abfallend descente descendant descendante bajada discesa descendente | go down"
    " | goes down | going down | en descente | qui descend | cuesta abajo | in discesa | hacia abajo"
    " | bergab gehen",
    "gently": "gently softly mildly",
    "steep": "steep steeply steil raide empinada ripida",
    "more": "more bigger larger greater higher mehr mas piu plus increase raise enlarge erhohe augmente"
    " aumenta",
    "less": "less smaller weniger moins menos meno reduce decrease lower verringere reduis reduce riduci",
    "much": "much far considerably significantly really lot strongly viel deutlich beaucoup mucho molto"
    " | a lot | a great deal | a good deal | by far | sehr viel",
    "slightly": "slightly somewhat bit little touch tad etwas leicht peu poco leggermente | a bit | a"
    " little"
    " | a touch | a tad | a little bit | ein wenig | ein bisschen | un peu | un poco | un po",
    # numbers
    "by": "by um",
    "to": "to auf into towards zu | down to | up to",
    "at": "at bei",
    "of": "of dell von de del della di du d vom",
    "with": "with mit avec con having",
    "as": "as so wie que come tan aussi",
    "deg": "degrees degree deg ° grad grados grado gradi degre degres",
    "m": "m metres meters metre meter metros metro metri mt mtr",
    "km": "km kilometres kilometers kilometre kilometer",
    "ft": "ft feet foot",
    "%": "% percent prozent pourcent porcento | per cent | pour cent | por ciento | per cento",
    "times": "times mal fois veces volte x",
    "twice": "twice double doubled doppelt doppelte doppelten verdopple doublez doble duplica doppio doppia"
    " raddoppia | two times | deux fois | doble de | il doppio",
    "thrice": "thrice triple treble dreifach dreimal | three times",
    "half": "half halve halved halb halbe halbiere halbieren moitie mitad meta dimezza | half the",
    # where
    "after": "after following behind past nach hinter apres despues dopo | right after | just after"
    " | directly after | coming after | that follows | that comes after | out of | despues de | after that",
    "before": "before preceding leading vor avant antes | ahead of | right before | just before | in"
    " front of"
    " | leading to | leading into | leading up to | that leads to | leads to | that comes before | antes"
    " de | prima della | prima del | prima di",
    "between": "between zwischen entre tra fra | in between | connecting | that connects | which connects |"
    " joining | that joins | linking | that links",
    "at_end": "| at the end | at the very end | to the end | at end | am ende | am schluss | ans ende"
    " | zum schluss | a la fin | al final | alla fine | on the end | at the finish | onto the end"
    " | in the end | end of the road",
    "at_start": "| at the start | at the beginning | to the start | to the beginning | at the very start"
    " | am anfang | au debut | al principio | al inicio | all inizio | at the very beginning"
    " | in the beginning | onto the start",
    "at_mid": "| in the middle | in der mitte | au milieu | en el medio | nel mezzo | halfway",
    "on": "in on within im ins inside dans en nella nel sur sulla",
    # between clauses
    "and": "and und et y e &",
    "then": "because since weil then also but dann danach puis ensuite luego poi while whereas aber pero"
    " mais ma besides"
    " | and then | and also | as well as | afterwards",
    # that say nothing here
    "-": "please could can you would like want i we need be should must go goes going run runs"
    " just only now so very quite there here do does me us bitte ich mochte will sein werden wird"
    " s'il vous plait je veux que soit sea quiero por favor vorrei sia per for where which who"
    " one ones number no. nr numero nummer some any about around approximately roughly exactly"
    " ungefahr circa etwa environ current existing new present same thing way road's turn's instead really"
    " say see altogether went feels anywhere rest kannst konntest du konnen wurdest wurde wurden peux"
    " pourrais pouvez pourriez tu puedes podrias puede podria puoi potresti potrebbe devrait doit debe"
    " deberia deve dovrebbe ought well fosse necesito necesitamos necesita think possible combination combo"
    " sequence prefer plain everywhere uberall partout"
    " actually maybe perhaps together completely entirely fully totally hey hi ok okay thanks thank again"
    " still roadgpt shape section part piece segment segments angle's out off other"
    " au aux se al alla zur zum im am an auch nur have been get gets got makes making made whole"
    " entire ganze ganzen total rather fairly pretty such image sort kind my our your was were what"
    " that's i'd ordinary normal regular away"
    " quisiera fuera essere etre sure has through let's it's amount value additional extra bergwarts sich"
    " mir uns dalla dal nello su"
    " | than now | than it is | than it is now | than at present | than before"
    " | je veux que | quiero que | me gustaria que | voglio che | vorrei che | haz que | fais que | fais en"
    " sorte"
    " que | ich mochte dass | so that | have to | has to | to be | to become | would it be possible to | is"
    " it possible to | it would be nice if you could | it would be great if you could | it would be good to"
    " | it would be nice to | it would be better if | if you can | or so | if possible | wenn moglich | si"
    " possible | si es posible | se possibile | serait il possible de | how about | what about | ware es"
    " moglich | seria posible | sarebbe possibile | needs to | need to",
}
