"""Every command and option of the command line as it was on 2026-11-20, before commands were merged."""

EARLIER = {
    "run":
        "-n --roads --seed --out --reader --designer --driver --simulator --keep-driving --map-size "
        "--speed-limit --oob-tolerance --lane-departure --lane-width --verge --friction --geometry "
        "--rules --no-drive --no-plot --axes --format --export --model --base-url --provider --api "
        "--temperature --timeout --retries --max-completion --max-tokens --max-cost --price --record "
        "--replay --rounds --beamng-home --beamng-user --beamng-host "
        "--beamng-port --beamng-level --beamng-aggression --beamng-recycle --headless --nogpu --gfx "
        "--junit --json -q --quiet -v --verbose",
    "read":
        "--reader --map-size --table --json --alternatives --model --base-url --provider --api "
        "--temperature --timeout --retries --max-completion --max-tokens --max-cost --price --record "
        "--replay --rounds",
    "edit":
        "--out --model --base-url --provider --api --temperature --timeout --retries "
        "--max-completion --max-tokens --max-cost --price --record --replay --rounds --map-size "
        "--driver --no-drive --no-plot --format --json -q --quiet",
    "drive":
        "--seed --map-size --speed-limit --oob-tolerance --lane-departure --lane-width --verge "
        "--friction --driver --simulator --keep-driving --geometry --rules --beamng-home "
        "--beamng-user --beamng-host --beamng-port --beamng-level --beamng-aggression "
        "--beamng-recycle --headless --nogpu --gfx --junit --json -q --quiet -v --verbose",
    "check":
        "--rules --map-size --geometry --json -q --quiet -v --verbose",
    "plot":
        "--failures --faults --worst --out --axes --format --map-size --geometry -q --quiet",
    "faults":
        "--repeat --minimise -j --driver --no-plot -q --quiet",
    "view":
        "--out --failures --faults --worst --open --map-size --geometry",
    "film":
        "--view --out --fps --size --seconds --all --failures --faults --worst --map-size --geometry "
        "-q --quiet",
    "export":
        "--to --failures --faults --worst --out --speed-limit --lane-width --verge --friction "
        "--geometry -q --quiet",
    "import":
        "--road --out --keep-place -q --quiet",
    "compare":
        "--out --no-plot --mirror --json --axes --map-size --geometry",
    "report":
        "--open --junit",
    "study":
        "",
    "study thesis":
        "-n --roads --no-drive --designer --seed --out --workers --reader --driver --simulator "
        "--keep-driving --geometry --map-size --speed-limit --oob-tolerance --lane-departure "
        "--lane-width --verge --friction --no-plot -q --quiet --model --base-url --provider --api "
        "--temperature --timeout --retries --max-completion --max-tokens --max-cost --price --record "
        "--replay --rounds",
    "study alignment":
        "-n --roads --drive --designer --seed --out --workers --reader --driver --simulator "
        "--keep-driving --geometry --map-size --speed-limit --oob-tolerance --lane-departure "
        "--lane-width --verge --friction --no-plot -q --quiet --model --base-url --provider --api "
        "--temperature --timeout --retries --max-completion --max-tokens --max-cost --price --record "
        "--replay --rounds",
    "study survey":
        "",
    "study survey new":
        "--from --out --asks --contact --pairs --seed --no-films",
    "study survey serve":
        "--raters --open --port --host --url",
    "study survey analyse":
        "--out --synthetic --agreement --seed",
    "campaign":
        "-n --tests --goal --generator --seconds --seed --out -j --workers --executor --address "
        "--reader --designer --driver --simulator --keep-driving --map-size --speed-limit "
        "--oob-tolerance --lane-departure --lane-width --verge --friction --geometry --rules "
        "--no-drive --model --base-url --provider --api --temperature --timeout --retries "
        "--max-completion --max-tokens --max-cost --price --record --replay --rounds "
        "--beamng-home --beamng-user --beamng-host --beamng-port --beamng-level "
        "--beamng-aggression --beamng-recycle --headless --nogpu --gfx --faults --minimise --repeat "
        "--junit --json -q --quiet",
    "resume":
        "-j --workers --executor --address --max-tokens --max-cost --driver --base-url --faults "
        "--minimise --repeat --junit --json -q --quiet",
    "status":
        "--json",
    "top":
        "--once",
    "redrive":
        "--failures --faults --worst --out --no-plot --driver --axes --format",
    "show":
        "--failures --faults --worst",
    "learn":
        "",
    "learn data":
        "--hand -n --number --seed",
    "learn train":
        "--hand --weights --installed --steps --size --workers --own --seed",
    "learn export":
        "--hand --chats --seed",
    "learn chats":
        "-n --number --seed",
    "learn evaluate":
        "--hand --split --reader --misses --card",
    "sbft":
        "--module-name --class-name --module-path --python --time-budget --test-budget --map-size "
        "--oob-tolerance --speed-limit --driver --simulator --beamng-home --beamng-user --beamng-host "
        "--beamng-port --beamng-level --beamng-aggression --beamng-recycle --headless --nogpu --gfx "
        "--seed --patience --out --plot --no-plot --axes --format --debug --client --json -q --quiet "
        "-v --verbose",
    "sdc":
        "",
    "sdc serve":
        "--port --host -q --quiet",
    "parts":
        "--json",
    "config":
        "",
    "config show":
        "--origin --json --model --base-url --provider --api --temperature --timeout --retries "
        "--max-completion --max-tokens --max-cost --price --record --replay --rounds",
    "beamng":
        "",
    "beamng selftest":
        "--out --repeats --beamng-home --beamng-user --beamng-host --beamng-port --beamng-level "
        "--beamng-aggression --beamng-recycle --headless --nogpu --gfx",
    "doctor":
        "--json",
}  # fmt: skip
