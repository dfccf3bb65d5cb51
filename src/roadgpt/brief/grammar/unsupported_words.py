"""Words that would change the road but that a Brief cannot express; they are reported as not understood.

The format is that of ``english.py``. Phrases under the key '?' have no other effect; the words next to them
are still read.
"""

UNSUPPORTED_WORDS: dict[str, str] = {
    "?": "immediately | directly | directly after each other | back to back | in quick succession"
    # wishes that compare one thing with another
    " | sharper than the one before | tighter than the one before | gentler than the one before"
    " | wider than the one before | longer than the one before | shorter than the one before"
    " | steeper than the one before | sharper than the last | tighter than the last"
    " | longer than the last | gentler than the last | sharper than the previous one"
    " | tighter than the previous one | longer than the previous one | gentler than the previous one"
    " | sharper and sharper | tighter and tighter | steeper and steeper | wider and wider"
    " | longer and longer | shorter and shorter | gentler and gentler | flatter and flatter"
    " | increasingly sharp | increasingly tight | increasingly steep | increasingly gentle"
    " | progressively tighter | progressively sharper | progressively steeper | progressively gentler"
    " | ever sharper | ever tighter | ever steeper | ever wider | ever longer"
    " | getting tighter | getting sharper | getting steeper | getting flatter | getting wider"
    " | gets tighter | gets sharper | gets steeper | gets flatter | gets wider | gets gentler"
    " | get tighter | get sharper | get steeper | get flatter | get wider | get gentler"
    " | sharper | tighter | steeper | flatter | gentler | wider | tightening | widening"
    # things that are to be alike
    " | the same again | the same once more | same | the same | of the same radius | with the same radius"
    " | the same radius | same radius"
    " | of equal radius | equal radius | equal radii | identical | identically | equal | equally"
    " | constant radius | of constant radius | constant curvature | the same size | of the same size"
    " | same length | the same length | of the same length | of equal length | equally long"
    " | equally spaced | evenly spaced | evenly | spaced | regular intervals | at regular intervals"
    " | similar | symmetric | symmetrical | mirrored"
    # between things
    " | no straight between | no straight between them | no straights between | no straights between them"
    " | without a straight between | without a straight between them | without straights between"
    " | without straights between them | without any straight between them | no straight in between"
    " | without a straight in between | no straight between the turns | without straights between the turns"
    " | no gap | no gap between them | without a gap | without pause"
    # order
    " | random order | in random order | in a random order | in no particular order"
    # the surface and what lies on it, the number of lanes and their width
    " | wet | dry | icy | ice | snow | snowy | slippery | rain | rainy | damp | muddy | foggy | fog"
    " | gravel | dirt | dual carriageway | one way | single lane | one lane | narrow",
    "turning_sum": "total turning | total turning of | turning sum | total heading change | turns a total of"
    " | total turning angle | sum of all turns",
    "? road": "racetrack | race track",
}
