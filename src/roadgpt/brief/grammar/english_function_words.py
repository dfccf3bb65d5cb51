"""English vocabulary, second part: numbers, bounds, units, conjunctions, scope, and words without effect.

The format is that of ``english.py``. The key '-' lists words that are understood but do not affect the shape
of the road.
"""

FUNCTION_WORDS: dict[str, str] = {
    # numbers
    "#0": "zero | nil",
    "#1": "one | a single | single | just a | solitary | lone | just a single",
    "#0.5": "half a",
    "#2": "two | a couple of | a couple | couple of | couple | a pair of | pair of | double | pair",
    "#3": "three | triple | trio of | a trio of",
    "#4": "four",
    "#5": "five",
    "#6": "six | half a dozen | half dozen",
    "#7": "seven",
    "#8": "eight",
    "#9": "nine",
    "#10": "ten",
    "#11": "eleven",
    "#12": "twelve | a dozen | dozen",
    "#13": "thirteen",
    "#14": "fourteen",
    "#15": "fifteen",
    "#16": "sixteen",
    "#17": "seventeen",
    "#18": "eighteen",
    "#19": "nineteen",
    "#20": "twenty",
    "#30": "thirty",
    "#40": "forty | fourty",
    "#50": "fifty",
    "#60": "sixty",
    "#70": "seventy",
    "#80": "eighty",
    "#90": "ninety",
    "#100": "hundred | a hundred",
    "#1000": "thousand | a thousand",
    "#3+": "several | a series of | series of | a sequence of | sequence of | a number of"
    " | a string of | string of | a set of | set of | various | a succession of | succession of"
    " | a bunch of | bunch of | a row of",
    "#3-5": "a few | few | a handful of | handful of",
    "#4+": "many | lots of | a lot of | numerous | plenty of | loads of | tons of | countless"
    " | full of | a lot",
    "#2+": "multiple | some | more than one | a combination of | combination of | a mix of | mix of"
    " | more than a single",
    "times2": "twice | two times | 2 times",
    "times": "times",
    ">=": "at least | no fewer than | no less than | not less than | not fewer than | minimum of"
    " | a minimum of | minimum | min | or at least | at minimum | at a minimum | not below"
    " | never below | from at least | no smaller than | no shorter than | not under"
    " | never less than | greater than or equal to | upwards of | ≥ | >=",
    "<=": "at most | no more than | not more than | maximum of | a maximum of | up to | maximum"
    " | max | no greater than | not exceeding | not exceed | no longer than | never more than"
    " | at the most | at maximum | never exceeding | does not exceed | not above | never above"
    " | less than or equal to | limited to | not greater than | no larger than | not longer than"
    " | not over | capped at | within | ≤ | <=",
    ">": "sharper than | more than | greater than | over | above | exceeding | longer than"
    " | larger than | beyond | > | exceeds | in excess of | bigger than",
    "<": "gentler than | less than | fewer than | under | below | shorter than | smaller than | <",
    "exact": "exactly | precisely | just | only | about | around | roughly | approximately | approx"
    " | circa | ca | some | nearly | almost | close to | total of | a total of | ~ | ≈ | ±"
    " | equal to | near | or so | give or take",
    "or_more": "+ | or more | or greater | and more | and up | or above | or longer | plus | at least"
    " | or steeper | minimum | min | or over | or bigger",
    "or_less": "or less | or fewer | or below | at most | or shorter | maximum | max | tops | or under"
    " | or smaller",
    "m": "m | metre | metres | meter | meters | mtr | mtrs",
    "km": "km | kilometre | kilometres | kilometer | kilometers | kms",
    "ft": "ft | feet | foot",
    "yd": "yd | yard | yards | yds",
    "mile": "mile | miles | mi",
    "%": "percent | per cent | pct | percents | %",
    "deg": "degree | degrees | deg | degs | °",
    "in_ten": "in",
    "radius": "r | radius | radii | radiuses | radius of curvature",
    "length": "length | total length | in length | overall length | lengths",
    "height #0 m": "net climb zero | zero net climb | no net climb | no net height | net climb of zero"
    " | a net climb of zero | ends at the same height | ends as high as it starts",
    "free_turns": "with or without turns | turns left open | with or without bends",
    "height": "height | elevation | altitude | vertical | vertically | elevation gain | height gain"
    " | net climb | height difference | elevation difference | elevation change | total climb"
    " | of climb | total ascent | of height | of elevation | in height | in elevation"
    " | in altitude | higher | of altitude | net elevation gain | net gain | of ascent"
    " | of climbing | ascent of | gain of | altitude gain | difference in height | height change",
    "turned": "of turning in all | of turning in total | of turning altogether | total heading change"
    " | total heading change of | heading change in all | heading change in total | total turning"
    " | of heading change in all | of heading change in total | overall heading change | cumulative turning"
    " | cumulative heading change | accumulated heading change | total of turning | of total turning"
    " | of total heading change | total turning angle | sum of all turns | sum of the turn angles",
    "loss": "elevation loss | height loss | altitude loss | net drop | net fall | net descent | lower"
    " | total descent | of descent | loss of | net elevation loss | total drop",
    "gain": "gain | gains | gaining",
    "lose": "lose | loses | losing",
    "across": "wide | high | deep | width | tall | broad | lane width | road width",
    "speed": "kmh | kph | mph | kilometres per hour | kilometers per hour | miles per hour",
    # words that join things
    ",": ", | as it | while | whilst | as the road | when it | but | yet | while it",
    "/": "/",
    "stop": ". | ! | ? | ; | \n",
    "colon": ": | -- | namely | i e | viz",
    "open": "( | [",
    "close": ") | ]",
    "hyphen": "-",
    "and": "and | & | as well as | plus | also | along with | together with | + | and also | plus also",
    "or": "or | nor | and or",
    "then": "then | followed by | followed | after that | afterwards | afterward | next | subsequently"
    " | thereafter | before | → | leads into | leading into | leading to | leads to"
    " | continues with | continuing with | later | and then | which leads to | which leads into"
    " | succeeded by | from there | after which | before it"
    " | after this | and next | onto"
    " | continues into | turns into | transitions into | transitioning into | transitions to"
    " | flows into | flowing into | gives way to | opens into | opens onto | before going into"
    " | which then | and after that | right before | just before"
    " | shortly before | and afterwards | feeding into | feeds into"
    " | becomes | becoming | followed up by | connects to | merges into | continuing into"
    " | shortly followed by | before finally",
    "enter": "into",
    "into": "through | along | around | round | via | past | across | as it goes through | during"
    " | negotiating | while going through | while it goes through | over",
    "except": "except for | except | apart from | with the exception of | but for | excepting",
    "with": "whose | with | w /"
    " | w | has | have | having | contains | contain | containing | including | includes"
    " | include | featuring | features | consisting of | made of | made up of | comprising"
    " | that has | consists of | comprises | consist of | made from | which has | there are"
    " | there is | shaped by | that includes | that contains | composed of | where"
    " | consisting in | which contains | which includes | plus a | should have | must have"
    " | needs | built from | contained | incorporating | incorporates | characterized by"
    " | boasting",
    "for": "for | lasting",
    "first_of_all": "first | initially | at first | first of all | firstly | to start | to begin with"
    " | to begin | to start with | at the outset",
    "start": "start with | starts with | starting with | begin with | begins with | beginning with"
    " | starts | start | starting | begins | begin | beginning | starting in | starting on"
    " | starts on | starts in | begins in | begins on | opens with | opening with | starting off"
    " | starts off | starts off with | starts out | starts out with | begin on | begin in"
    " | start in | start on | beginning in | beginning on | starts by | begins by | start by"
    " | starting by | starts from | start off with | begins as | starts as | sets off"
    " | sets off with | starts going | kicks off with | begins going | leads off with"
    " | starting from",
    "end": "a final | a last | end with | ends with | ending with | end in | ends in | ending in"
    " | ends | end | ending | finish | finishes | finish with | finishes with | finishing with"
    " | finishing in | finishing | finish in | finishes in | ends on | ending on | finally"
    " | lastly | at last | concludes with | concluding with | conclude with | terminates in"
    " | terminating in | to finish | and finally | closes with | closing with | finishing on"
    " | finishes on | and ends | ends up with | ending up with | ends up in | before ending in"
    " | before ending with | before finishing with | before ending | to end | in the end"
    " | ends off with | ends by | ending by | ends going | and lastly | culminates in"
    " | culminating in | wraps up with | finally ends | finally ending with | finishes off with"
    " | finished by | finish off with | then ends | then ends with | then ends in"
    " | rounded off by | rounds off with | end on | ends as",
    "after": "after | preceded by | following | coming after | once past | upon leaving"
    " | after passing | once through | right after | just after"
    " | shortly after | out of",
    "between": "between | in between | separated by | connected by | joined by | linked by"
    " | interspersed with | broken up by | split by | divided by | spaced by | interrupted by"
    " | with breaks of",
    "half1": "the first half | first half | in the first half | for the first half",
    "half2": "the second half | second half | in the second half | for the second half | the other half",
    "each_side": "in each direction | to each side | each way | on each side | to either side"
    " | in either direction | per side | each side",
    "in_between": "between them | in between them | between the turns | between the bends"
    " | between the curves | between each | between each turn | between turns | between the two"
    " | between the hairpins | between bends | between curves | between the two turns"
    " | between each other | between these | between every turn | between the switchbacks"
    " | between each bend | between both | between both turns | between hairpins"
    " | between each of them | between the two bends | between the two hairpins"
    " | between the corners",
    "at_end": "at the end | at its end | near the end | as the last element | to finish with"
    " | toward the end | towards the end | in the final section | at the finish | as a finale"
    " | last of all",
    "at_top": "at the top | at the summit | on top | at the crest | at the top of the hill | at its top",
    "at_bottom": "at the bottom | at the foot | at the lowest point | at the bottom of the hill"
    " | at the bottom of the valley",
    "at_start": "at the start | at the beginning | at its start | near the start | in the beginning"
    " | at its beginning",
    "in_middle": "in the middle | halfway | midway | half way | in its middle | somewhere in the middle"
    " | in the centre | in the center | at the halfway point",
    "again": "again | another | one more | once more | a second | a further | yet another | a third",
    "repeat": "repeated | repeat | repeats | repeating | this pattern | repeat this | repeated over",
    # scope
    "a": "a | an",
    "the": "the",
    "all": "all | all of them | all of which | each of them | each of which",
    "each": "each | every | any | per turn | apiece",
    "each turn": "each turn | every turn | each bend | every bend | all bends | all curves | all corners"
    " | each curve | every curve | each corner | every corner | all turns | all the turns"
    " | all the bends | all the curves | any turn",
    "both": "both | both of them | both of which | the two of them",
    "whole": "all the way | throughout | the whole way | the entire way | overall | the whole time"
    " | all along | the whole road | whole road | entire road | the entire road | everywhere"
    " | constantly | continuously | steadily | always | continuous | constant | constantly going"
    " | entirely | completely | steady | from start to finish | from beginning to end"
    " | from start to end | the entire length | the whole length | throughout its length"
    " | all the time | consistently | whole | entire | the complete road | relentlessly"
    " | non stop | all over | uniformly | its entire length | its whole length | the entire time"
    " | the road as a whole | fully",
    "total": "totalling | totaling | adding up to | which add up to | that add up to | in total"
    " | in all | altogether | total | in sum | all in all | combined | all together | all told",
    "rest": "the rest | the others | others | remaining | the remaining | the other"
    " | the rest of them | the other ones",
    "other": "other | further",
    "half_of": "half of them | half of which | half of the turns | half of the bends | one half of them",
    "of_them": "of them | of which | of those | of these | among them | of the turns | of the bends"
    " | of the curves | out of them | of all turns",
    "last_one": "the last | the final | the last one | the final one | last | final",
    "last_n": "the last | the final",
    "nth1": "the first | the first one | 1st | the 1st",
    "nth2": "the second | second | the second one | 2nd | the 2nd",
    "nth3": "the third | third | the third one | 3rd | the 3rd",
    "nth4": "the fourth | fourth | 4th | the 4th | the fourth one",
    "nth5": "the fifth | fifth | 5th | the 5th | the fifth one",
    "nth6": "the sixth | sixth | 6th | the 6th",
    "nth7": "the seventh | seventh | 7th | the 7th",
    "nth8": "the eighth | eighth | 8th | the 8th",
    "same_hand": "in the same direction | the same way | in one direction | to the same side"
    " | same direction | all the same way | in the same sense",
    "alternating": "in different directions | different directions | alternating | alternate | alternates"
    " | alternately | alternatingly | in alternation | alternating directions"
    " | alternating sides | opposite | in alternating directions | opposing"
    " | in opposite directions | alternating direction | to alternating sides | switching sides"
    " | alternating hands | switching between | switches between | back and forth | side to side"
    " | from side to side | takes turns | in alternating order | opposite directions"
    " | in the opposite direction | the other way | alternation of | alternately to the"
    " | in opposing directions | alternated | changing direction each time"
    " | changes direction each time",
    "no": "w / o | w / o any | no | without | without any | not | never | none | free of | lacking"
    " | avoid | avoiding | avoids | devoid of | isn't | doesn't | don't | no single"
    " | not a single | neither | not any | without a single | excluding | that has no"
    " | absent | shouldn't | mustn't | not have any | nothing | cannot | zero number of | has no"
    " | does not | do not | won't",
    "too": "too | overly | very | really | extremely | quite | rather | so | super | pretty | fairly"
    " | especially | incredibly | particularly | extra | highly | somewhat | a bit | a little"
    " | relatively | ever | truly",
    "only": "only | exclusively | solely | nothing but | purely",
    "that": "that | which | it | this | who | car | driver | you | we | they",
    "road": "road | street | track | roadway | route | path | lane | trail | alley | avenue"
    " | boulevard | roads | lanes | streets | driveway | byway | carriageway | country lane"
    " | country road | pass road | backroad | back road | terrain"
    " | ground | layout",
    "hard": "hard",
    "hard_road": "challenging | challenge | challenges | difficult | demanding | tricky | stress"
    " | stresses | stressing | stressful | to break | nasty | extreme | brutal | torture"
    " | toughest | tough | hardest | adversarial | fail | fails | failing | failure | dangerous"
    " | hard to drive | push | pushes | treacherous | gruelling | grueling | most difficult"
    " | leave its lane | out of its lane | leave the lane | hard to follow | hard for"
    " | difficult for | to its limits | to the limit | at the limit | break | breaks | evil"
    " | wicked | vicious | technical | intense | drive off | run off | off the road | overwhelm"
    " | trouble | struggle | struggles | worst case | edge case | provoke | provokes | confuse"
    " | out of the lane | leaves its lane | leaves the lane | depart | departure | departures"
    " | lose control",
    # understood, but without effect on the shape
    "steep": "as steep as possible | as steep as it gets",
    "more_left": "more left turns than right turns | more left than right turns | more lefts than rights"
    " | more left than right",
    "more_right": "more right turns than left turns | more right than left turns | more rights than lefts"
    " | more right than left",
    "same_sides": "as many left as right turns | an equal number of left and right turns"
    " | as many right as left turns | equally many left and right turns"
    " | as many left turns as right turns | the same number of left and right turns",
    "-": "something | anything | ride | square | a square | getting | otherwise | else | elsewhere"
    " | in any order | any order | at all | drive | drives | way | plain | even | course | run"
    " | big | large | open | moderate | moderately | calm | of | to | at | is | are | be | being"
    " | on | in | by | from | as | if | its | their | there | these | those | them | should"
    " | must | shall | will | would | could | can | may | please | want | wants | like | need"
    " | let | lets | me | my | i | i'd | i'm | us | our | your | give | make | makes | making"
    " | create | generate | build | design | draw | produce | show | construct | provide"
    " | imagine | plan | get | gets | goes | go | going | runs | running | does | do | did"
    " | moves | moving | leads | leading | heads | heading | keeps | keep | keeping | stays"
    " | stay | staying | remains | remain | remaining | continues | continue | continuing"
    " | takes | take | taking | follow | follows | comes | come | coming | made | using | use"
    " | however | when | where | still | now | shortly | quick"
    " | quickly | slowly | right away | straight after | soon | nice | nicely | simple | basic"
    " | normal | ordinary | regular | standard | typical | beautiful | scenic | pretty | lovely"
    " | fun | interesting | random | arbitrary | new | novel | different | good | great | small"
    " | little | tiny | medium | medium sized | sized | kind | kinds | type | sort | form"
    " | shape | shaped | style | direction | directions | side | sides | angle | angles | angled"
    " | turning angle | heading change | size | value | amount | number | numbers"
    " | one after another | one after the other | in a row | consecutive | successive"
    " | succession | in succession | in sequence | in quick succession | back to back | sequence"
    " | series | combination | combinations | pattern | order | in this order | in that order"
    " | in order | respectively | each time | another one | element | elements | two lane"
    " | two lanes | 2 lane | two way"
    " | asphalt | asphalted | paved | tarmac | concrete | surface"
    " | rural | urban | city | town | village | suburban | residential | country"
    " | countryside | forest | woods | wooded | desert | coastal | coast | seaside | farm | park"
    " | industrial | scenery | landscape | hillside | hillsides | mountainside | valley | lake"
    " | river | empty | quiet | test | tests | testing | tested | lane keeping | lane keeper"
    " | keeper | lane assist | lane keep | assist | assistant | adas | lkas | system | systems"
    " | self driving | autonomous | automated | vehicle | vehicles | car | cars | driver"
    " | drivers | driving | ai | autopilot | agent | software | simulation | simulator"
    " | scenario | scene | map | virtual | model | designed | intended | meant | suitable | used"
    " | able | bring | brings | also | too | just | simply | actually | really | again | only"
    " | well | both | here | once | until | till | ahead | forward | forwards | off | out | onto"
    " | toward | towards | away | down to | up to the | top | bottom | foot | base | middle"
    " | point | points | place | places | position | distance | distances | apart | pass"
    " | passes | passing | crossing | crosses | reaching | reach | reaches | hits | before"
    " | back | itself | along | about | bit | lot | more | most | less | much | such"
    " | than | not only | not just | or so | each other | another | next to | keeps on"
    " | carries on | carry on | carrying on | proceeds | proceed | proceeding"
    " | per | x | s | d | it's | that's | there's | let's | hi | hello | hey | thanks | thank"
    " | okay | ok | for a while | a while | for some time | while still | blind | classic"
    " | proper | real | true | full | complete | rather | curvature | having a | smallest"
    " | largest | every single | was | were | been | has been | both of | because | since"
    " | although | though | instead | hence | therefore | so that | such that | in order to"
    " | want to see | i want | i would like | could you | can you | would you | i need | we need"
    " | looking | see | look | looks | pure | dedicated | beginner | beginners | novice"
    " | learner | learners | sunday | famous | old | modern | slow | who | what | between"
    " | roughly | clear | clean | distinct | separate | individual"
    " | intervals | within | gap | gaps"
    " | at least then",
}
