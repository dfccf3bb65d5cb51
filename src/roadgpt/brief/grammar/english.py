"""English vocabulary, first part: features along the road, left and right, shapes and slopes.

Each key of the table names one meaning, or several in a row; its value lists the phrases with that meaning,
separated by '|'. Accents, case and hyphens do not matter. '+' marks a plural, '~' a verb, '#' a number.
``handlers.py`` defines the effect of each meaning. If a phrase occurs under two keys, the first key is used.
Exception: a meaning that is a bound ('over') is only used next to a number.
"""

ROAD_WORDS: dict[str, str] = {
    # things along the road
    "turn": "turn | bend | curve | corner | kurve | arc | deflection | turning",
    "turn+": "changes of direction | direction changes | changes in direction | turns | bends | curves"
    " | corners | arcs | turnings",
    "turn~": "curving | curved | bending | veer | veers | veering | swing | swings | swinging | swerve"
    " | swerves | bear | bears | bearing | hook | hooks | hooking | jog | jogs | arcing",
    "left turn": "left hander | lefthander | leftie",
    "left turn+": "left handers | lefthanders",
    "right turn": "right hander | righthander",
    "right turn+": "right handers | righthanders",
    "sharp s_bend": "z shaped | z bend | z shaped bend",
    "sweeping turn": "sweeper",
    "sweeping turn+": "sweepers",
    "kink turn": "kink",
    "kink turn+": "kinks",
    "dogleg turn": "dogleg | dog leg",
    "dogleg turn+": "doglegs | dog legs",
    "deg90": "right angle | right angled | right angles | at right angles | at a right angle | quarter"
    " | perpendicular",
    "deg90 turn": "l shaped | l shape | quarter turn | square corner",
    "deg45": "half right angle",
    "straight": "straight | of straight road | of straight"
    " | straightaway | straight line | straight ahead | straight on | dead straight"
    " | straight away | perfectly straight | straightens | straightens out | straighten out"
    " | straightening out | beeline",
    "straight+": "straights | straightaways | straight lines",
    "crest": "crest | hump | hilltop | hill top | brow | summit | peak | crest the hill"
    " | crests the hill | crest a hill | crests a hill | crest of a hill | crest of the hill"
    " | over a hill | over the hill | over a crest | over the crest | over the top | over a hump"
    " | over a rise | knoll | blind crest | humpback | hump back | mound | brow of a hill"
    " | brow of the hill | cresting | cresting a hill | cresting the hill | over the brow"
    " | over the summit | over a summit | tops a hill | top of the hill | top of a hill"
    " | reach the top | reaches the top | hillcrest | hill crest | crossing a hill"
    " | climbs over a hill | climb over a hill | goes over a hill",
    "crest+": "crests | humps | hilltops | summits | peaks",
    "hill": "hill",
    "-": "in a valley | along a valley | valley road",
    "dip": "a valley | over a valley | dip | hollow | trough | sag | through a valley | across a valley"
    " | through a dip"
    " | into a dip | through the dip | through a hollow | into a hollow | depression",
    "dip+": "dips | hollows | troughs",
    "hairpin": "v shaped | hairpin | hair pin",
    "hairpin+": "hairpins | hair pins",
    "switchback": "switchback | switch back",
    "switchback+": "switchbacks | switch backs | switchbacking",
    "u_turn": "c shaped | u shaped | u turn | uturn | about turn | about face | horseshoe | horse shoe"
    " | turnaround | turn around | turns around | turn back on itself | turns back on itself"
    " | doubles back | double back | doubling back | doubles back on itself | turns back"
    " | turn back | u shaped turn | u shaped bend | u shaped curve | u bend | half circle"
    " | semicircle | semi circle | turns back the way it came | one eighty | reverses direction"
    " | turnabout | u shape",
    "u_turn+": "u turns | uturns | horseshoes | u bends | semicircles",
    "s_bend": "s bend | s curve | s turn | s shaped bend | s shaped curve | s shaped turn | s shape"
    " | sbend | scurve | reverse curve | ess | s corner | s shaped | s kurve | double bend"
    " | double curve",
    "s_bend+": "s bends | s curves | s turns | s shaped bends | s shaped curves | s shaped turns"
    " | s corners | sbends | scurves | reverse curves | double bends",
    "#3+ alternating turn+": "esses",
    "chicane": "chicane",
    "chicane+": "chicanes",
    "slalom": "slalom | slaloms | slaloming | slalom course | slalom section",
    "serpentine": "serpentine | serpentines | serpentining | sinuous",
    "zigzag": "zigzag | zig zag | zigzags | zig zags | zigzagging | zig zagging | zigzagged",
    "winding": "winding | winds | wind | twisty | twisting | twists | twist | curvy | bendy | meandering"
    " | meander | meanders | snaking | snakes | snake | snakes its way | winds its way"
    " | tortuous | squiggly | windy | wavy | wiggly | wiggle | wiggles | wiggling | weaving"
    " | weaves | weave | curvaceous | twists and turns | twist and turn | wends | wending"
    " | crooked",
    "spiral": "spiral | spirals | spiralling | spiraling | corkscrew | corkscrews | corkscrewing"
    " | helix | helical",
    "loop": "ends where it starts | ends where it began | back to the start | returns to the start"
    " | returns to its start | back to its start | figure of eight | figure eight | circle | circular"
    " | ring | oval | loops | racing oval"
    " | loop | full circle | complete circle | full loop | loop the loop | circuit | closed loop",
    "stretch": "segment | section | stretch | part | piece | leg | portion | sections | segments"
    " | stretches | parts | pieces",
    # sides and shapes
    "left": "left | left hand | lefthand | leftward | leftwards | to the left | lefts | port"
    " | left handed | leftbound | counterclockwise | anticlockwise | anti clockwise"
    " | counter clockwise | left side",
    "right": "right | right hand | righthand | rightward | rightwards | to the right | rights"
    " | starboard | right handed | rightbound | clockwise | right side",
    "gentle": "gentle | gently | easy | easily | lazy | lazily | slight | slightly | mild | mildly"
    " | soft | softly | shallow | smooth | smoothly | relaxed | light | lightly | subtle"
    " | subtly | mellow | comfortable | leisurely | gradual | gradually | tame | loose",
    "sweeping": "sweeping | sweep | sweeps | wide | broad | large radius | big radius | wide radius"
    " | fast | widely",
    "sharp": "sharp | sharply | tight | tightly | abrupt | abruptly | small radius | acute"
    " | sudden | suddenly | severe | severely | aggressive | aggressively"
    " | tight radius | pointed | snappy",
    "long": "long | lengthy | longer | extended | longish | elongated",
    "short": "short | brief | shorter | briefly | shortish",
    # slopes
    "up": "uphill | up hill | upward | upwards | upslope | up | up a hill | up the hill"
    " | up a hillside | up the hillside | up a mountain | up the mountain | up a slope"
    " | up the slope | up a mountainside | up the mountainside | positive incline"
    " | positive slope | positive gradient | positive grade | upgrade | up a steady slope",
    "up~": "climb | climbs | climbing | rise | rises | rising | ascend | ascends | ascending"
    " | ascent | ascents | mount | mounts | mounting | incline | inclines | inclining | inclined"
    " | gaining height | gains height | gain height | gaining altitude | gains altitude"
    " | gaining elevation | gains elevation | goes up | go up | going up | heading up | heads up"
    " | leads up | leading up | slopes up | sloping up | slopes upward | slopes upwards"
    " | climbs up | climb up | uphills | climbs uphill | climb uphill | goes uphill"
    " | going uphill | go uphill | heads uphill | heading uphill | leads uphill | leading uphill"
    " | runs uphill | running uphill | up ramp | climbs a hill | climb a hill | climbing a hill"
    " | climbs the hill | climb the hill | climbs a mountain | climbing a mountain"
    " | climb a mountain | moving uphill | sloping upward | sloping upwards | inclination"
    " | uphill slope | uphill grade | uphill gradient | upward slope | climbs up a hill"
    " | rises up | lifts | soars | gain elevation | uphill climb | rises uphill | ascends uphill"
    " | upward incline",
    "down": "down the other side | downhill | down hill | downward | downwards | downslope | down"
    " | down a hill"
    " | down the hill | down a hillside | down the hillside | down a mountain"
    " | down the mountain | down a slope | down the slope | down a mountainside"
    " | down the mountainside | negative incline | negative slope | negative gradient"
    " | negative grade | downgrade | into a valley | into the valley | down into a valley"
    " | down into the valley | off the mountain | back down | declining",
    "down~": "descend | descends | descending | descent | descents | drop | drops | dropping | fall"
    " | falls | falling | decline | declines | declining | sink | sinks | sinking | plunge"
    " | plunges | plunging | losing height | loses height | lose height | losing altitude"
    " | losing elevation | goes down | go down | going down | heading down | heads down"
    " | leads down | leading down | slopes down | sloping down | slopes downward"
    " | slopes downwards | drops away | falls away | drops down | downhills | goes downhill"
    " | going downhill | go downhill | heads downhill | heading downhill | leads downhill"
    " | leading downhill | runs downhill | running downhill | plummets | plummet"
    " | downhill slope | downhill grade | downhill gradient | downward slope | moving downhill"
    " | sloping downward | sloping downwards | dives | dive | diving | comes down | coming down"
    " | come down | drops off | dropping off | descends downhill | downward incline"
    " | loses elevation | lose elevation | dipping | tumbles",
    "flat": "flat | level | flatly | flat ground | level ground | horizontal | horizontally | plane"
    " | levelled | leveled | flat terrain | level terrain | at grade | flat land | flatland"
    " | zero incline | no incline | zero slope | no slope | zero gradient | no gradient"
    " | without any incline | without incline | without slope | without slopes | no hills"
    " | without hills | no elevation change | without elevation change"
    " | without any elevation change | no elevation changes | no slopes | without climbing"
    " | without any hills | without any slope | constant height | constant elevation"
    " | constant altitude | same height | neither up nor down | neither uphill nor downhill"
    " | neither rising nor falling | zero grade | no inclines | without inclines"
    " | no height difference | no grade | without elevation changes | without any slopes"
    " | no ups or downs | no ups and downs | without any climb | unsloped | no climb"
    " | no climbs or descents | without any elevation | no elevation | on flat ground"
    " | on level ground | no change in elevation | no change in height",
    "flat~": "levels off | levels out | level off | level out | levelling off | leveling off"
    " | levelling out | leveling out | flattens | flattens out | flatten out | flattening"
    " | flattening out | levels | flatten | flattens off | evens out | plateau | plateaus"
    " | plateauing | levels itself",
    "nearly": "mainly | nearly | almost | mostly | roughly | virtually | practically | basically"
    " | largely | fairly",
    "steep": "steep | steeply | precipitous | steepness",
    "slope": "slope | slopes | gradient | grade | sloping | sloped | ramp | tilt | pitch | hillslope"
    " | gradients | grades | inclination angle",
    "up , down , up": "up and down and up again | up and down and up | up down and up again",
    "up , down , up , down": "up and down and up and down | up and down and up and down again",
    "hilly": "hilly | goes up and down | going up and down | go up and down | runs up and down"
    " | rolling | undulating | undulates | undulation | undulations | ups and downs"
    " | up and down | rollercoaster | roller coaster | hills | rolling hills | crests and dips"
    " | dips and crests | humps and dips | climbs and descents | climbs and drops"
    " | rises and falls | uphills and downhills | uphill and downhill | over hill and dale"
    " | rises and dips | peaks and valleys | downs and ups | down and up | whoops",
    "changes": "changes of slope | change of slope | slope changes"
    " | changes between climbing and falling | changes between uphill and downhill"
    " | changes of gradient | elevation changes | elevation change",
    "mountain": "mountain | mountainous | alpine | mountain pass | alps | mountains",
    "highway": "highway | motorway | freeway | expressway | autobahn | interstate | speedway",
    "highest": "steepest | steepest grade | steepest gradient | steepest point | steepest section"
    " | steepest part | maximum steepness",
    "highest <=": "no slope steeper than | no slopes steeper than | no grade steeper than"
    " | no gradient steeper than | no slope over | no slope above | no slope more than"
    " | no slope of more than | no slope greater than | no slope exceeding | no grade over"
    " | no gradient over | no grade above | no gradient above | no climb steeper than"
    " | no hill steeper than | no incline steeper than | max grade | maximum grade | maximum gradient"
    " | maximum slope | max slope | max gradient"
    " | maximum incline | max incline | grade limit | no steeper than | not steeper than"
    " | never steeper than | nowhere steeper than | no steeper",
    "highest >": "steeper than",
    "radius >=": "no tighter than | never tighter than | not tighter than | nowhere tighter than",
    "radius <=": "no wider than",
    "radius <": "tighter than",
}
