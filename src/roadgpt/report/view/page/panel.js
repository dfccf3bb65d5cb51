// A panel: one road with its texts, its stage and its strips.

function makePanel(scene, fastest, { moveTo, wentFree, hasLine }) {
  const section = document.getElementById("panel").content.firstElementChild.cloneNode(true);
  const find = (name) => section.querySelector(name);
  const trip = tripOf(scene);
  document.getElementById("panels").append(section);
  write(find, scene, trip, fastest, moveTo);

  const stage = stageIn(section, scene, trip, fastest);
  const cameras = stage && makeCameras(stage, trip, (isDragged) => {
    if (isDragged) wentFree();
    panel.isStale = true;
  });
  const sheets = [
    makePlan(find(".plan canvas"), scene, trip, fastest, moveTo),
    makeStrip(find(".height canvas"), scene, trip, heightOf(scene), moveTo),
    makeStrip(find(".second canvas"), scene, trip, trip.isDriven ? speedOf(scene, fastest) : bendOf(scene), moveTo),
  ];
  if (isAmong(scene)) sheets.push(makeStrip(find(".near canvas"), scene, trip, closenessOf(scene, trip), moveTo));
  else find(".near").remove();

  const panel = {
    trip, stage, cameras, section,
    isStale: true,
    pose: trip.at(0),
    fit() {
      if (stage) {
        stage.fit();
        cameras.fit();
      }
      sheets.forEach((sheet) => sheet.fit());
      panel.isStale = true;
    },
    draw(time) {
      const pose = trip.at(Math.min(time, trip.duration));
      panel.pose = pose;
      tell(find, scene, trip, pose, time);
      sheets.forEach((sheet) => sheet.draw(pose));
      if (stage) {
        stage.place(pose);
        cameras.follow(Math.min(time, trip.duration));
        stage.draw(cameras.away, hasLine());
      }
      panel.isStale = false;
    },
  };
  return panel;
}

const isAmong = ({ others }) => Boolean(others && others.actors.length);

function stageIn(section, scene, trip, fastest) {
  const canvas = section.querySelector(".scene");
  if (drawsSolids()) return makeStage(canvas, scene, trip, fastest);
  section.querySelector(".nothing").hidden = false;
  for (const name of [".scene", ".hint"]) section.querySelector(name).hidden = true;
  return null;
}

// Has this browser WebGL 2? What was made to find out is given back at once.
function drawsSolids() {
  const context = document.createElement("canvas").getContext("webgl2");
  const release = context && context.getExtension("WEBGL_lose_context");
  if (release) release.loseContext();
  return Boolean(context);
}

// An event as a row of the list: when, where, what; a press goes there.
function listed({ who, what, time, s, until, why }, moveTo) {
  const row = document.createElement("li");
  const when = document.createElement(time === null ? "b" : "button");
  when.textContent = time === null ? "never" : `${time.toFixed(1)} s`;
  if (time !== null) when.addEventListener("click", () => moveTo(time));
  const where = document.createElement("i");
  where.textContent = s === null ? "" : `${s.toFixed(0)} m`;
  row.append(when, where, `${who}: ${what}${until === null ? "" : `, until ${until.toFixed(1)} s`}${why ? `: ${why}` : ""}`);
  return row;
}

const FRESH = 3; // s for which an event is told

// Who is ahead in the lane, or else nearest, and what has just begun.
function tellOthers(find, scene, time) {
  const last = scene.events.filter((event) => event.time !== null && event.time <= time + 1e-6 && time < event.time + FRESH).pop();
  find(".hud .event").hidden = !last;
  find(".hud .event").textContent = last ? `${last.who}: ${last.what}` : "";
  const { away, whom, isAhead } = isAmong(scene) ? scene.others.near : { away: [] };
  const n = Math.min(Math.round(time / 0.1), away.length - 1);
  const isNear = n >= 0 && away[n] !== null;
  find(".hud .other").hidden = !isNear;
  if (!isNear) return;
  const actor = scene.others.actors[whom[n]];
  const speed = Math.abs(kmh(actor.speed[clamp(n - actor.first, 0, actor.speed.length - 1)]));
  find(".hud .other").textContent = `${isAhead[n] ? "gap" : "nearest:"} ${away[n].toFixed(1)} m to ${actor.name}, ${speed < 1 ? "standing" : `${speed.toFixed(0)} km/h`}`;
}

// Texts of a description are set as text, never as markup.
function write(find, scene, trip, fastest, moveTo) {
  find(".title").textContent = scene.title;
  find(".badge").textContent = scene.outcome;
  find(".verdict").hidden = !scene.outcome;
  find(".badge").style.background = scene.colour;
  find(".badge").style.color = scene.letters;
  find(".said").textContent = scene.description;
  find(".origin").textContent = scene.about;
  find(".words p").textContent = scene.words;
  find(".words").hidden = !scene.words;
  const never = scene.events.filter(({ time }) => time === null).length;
  find(".events").hidden = !scene.events.length;
  find(".events summary").textContent = `${scene.events.length} events${never ? `, ${never} of them never happened` : ""}`;
  find(".events ol").append(...scene.events.map((event) => listed(event, moveTo)));
  find(".hint").textContent = matchMedia("(pointer: coarse)").matches
    ? "drag to look around, pinch to come nearer"
    : "drag to look around, scroll to come nearer";
  find(".second figcaption").innerHTML = trip.isDriven ? "speed, km/h <i>over distance, m</i>" : "bends: 100 m / radius <i>left is up</i>";
  find(".legend").hidden = !trip.isDriven;
  find(".legend .high").textContent = Math.round(kmh(fastest));
  const stops = [0, 0.25, 0.5, 0.75, 1].map((share) => css(speedColour(share)));
  find(".legend i").style.background = `linear-gradient(90deg, ${stops.join(",")})`;
}

function tell(find, scene, trip, pose, time) {
  const middle = pose.t - (pose.middle ?? offsetAt(scene.road, scene.road.lanes.middle, pose.s));
  const side = middle > 0 ? "left" : "right";
  const share = Math.round(100 * pose.outside);
  const isOver = trip.isDriven && time >= trip.duration;
  find(".hud .speed").textContent = trip.isDriven ? `${kmh(pose.speed).toFixed(0)} km/h` : `${pose.s.toFixed(0)} m`;
  find(".hud .place").textContent = trip.isDriven
    ? `${pose.s.toFixed(0)} m of ${scene.road.length.toFixed(0)} m${isOver ? `, ended at ${trip.duration.toFixed(1)} s` : ""}`
    : `of ${scene.road.length.toFixed(0)} m`;
  tellOthers(find, scene, Math.min(time, trip.duration));
  const lane = find(".hud .lane");
  lane.textContent = trip.isDriven
    ? share > 0 ? `${share} % of the car outside its lane` : `${Math.abs(middle).toFixed(2)} m ${side} of the lane's middle`
    : "nobody drove here: the view follows the lane";
  lane.classList.toggle("out", share > 0);
  lane.style.borderColor = (trip.isDriven && severeColour(scene, pose)) || "transparent";
}
