// The player: one clock for all panels.

const CAMERAS = ["behind", "bonnet", "free"];
const scenes = JSON.parse(document.getElementById("data").textContent);
const fastest = Math.max(10 / 3.6, ...scenes.map((scene) => (scene.drive ? extent(scene.drive.columns.speed)[1] : 0)));
document.getElementById("panels").className = (scenes.length > 1 ? "two" : "one") + (scenes.some(isAmong) ? " among" : "");

const player = {
  time: 0,
  rate: 1,
  camera: "behind",
  isPlaying: false,
  isLineShown: true,
  hasLine: () => player.isLineShown,
  moveTo(time) {
    player.time = clamp(time, 0, player.duration);
    stale();
  },
  toggle() {
    if (!player.isPlaying && player.time >= player.duration) player.time = 0;
    player.isPlaying = !player.isPlaying;
    stale();
  },
  setRate(rate) {
    player.rate = rate;
    stale();
  },
  // Asked for, the free camera shows the whole road; whoever drags another camera keeps its view instead.
  choose(name) {
    player.camera = name;
    for (const { cameras } of panels) {
      if (!cameras) continue;
      cameras.choose(name);
      if (name === "free") cameras.overview();
    }
    stale();
  },
  wentFree() {
    player.camera = "free";
    panels.forEach(({ cameras }) => cameras && cameras.choose("free"));
    document.querySelectorAll(".hint").forEach((hint) => hint.classList.add("gone"));
    stale();
  },
  toCar() {
    if (player.camera !== "free") player.choose("free");
    panels.forEach(({ cameras, trip }) => cameras && cameras.toCar(Math.min(player.time, trip.duration)));
    stale();
  },
  toMark() {
    const times = player.marks.map(({ time }) => time);
    if (times.length) player.moveTo(times.find((time) => time > player.time + 0.01) ?? times[0]);
  },
  toContact() {
    if (player.contacts.length) player.moveTo(player.contacts.find((time) => time > player.time + 0.01) ?? player.contacts[0]);
  },
  toggleLine() {
    player.isLineShown = !player.isLineShown;
    stale();
  },
  clock() {
    const isDriven = panels.some(({ trip }) => trip.isDriven);
    const [now, all] = [player.time, player.duration];
    return isDriven ? `${now.toFixed(1)} / ${all.toFixed(1)} s` : `${(now * PACE).toFixed(0)} / ${(all * PACE).toFixed(0)} m`;
  },
};

await Promise.all(Object.values(PICTURES).map((picture) => picture.decode()));
const panels = scenes.map((scene) => makePanel(scene, fastest, player));
player.duration = Math.max(...panels.map(({ trip }) => trip.duration));
player.marks = scenes.flatMap(({ places, events }) => [
  ...events.filter(({ time }) => time !== null).map(({ time }) => ({ time, colour: "var(--soft)" })),
  ...places.filter(({ time, text }) => text && time !== null),
]).sort((a, b) => a.time - b.time);
player.contacts = scenes.flatMap(({ others }) => (others ? others.contacts : [])).map(({ time }) => time).sort((a, b) => a - b);
document.body.classList.toggle("has-contact", player.contacts.length > 0);
["partly", "mostly", "failed"].forEach((name, n) => document.body.style.setProperty(`--${name}`, [...scenes[0].severe.colours, scenes[0].severe.failed][n]));
document.body.classList.toggle("on-route", scenes.some(({ network }) => network && network.hasRoute));
const showBar = wireBar(player);

function stale() {
  panels.forEach((panel) => { panel.isStale = true; });
}

function fit() {
  panels.forEach((panel) => panel.fit());
}

let last = null;
let frames = 0;

function frame(now) {
  const passed = last === null ? 0 : Math.min(0.25, (now - last) / 1000);
  last = now;
  if (player.isPlaying) {
    player.moveTo(player.time + passed * player.rate);
    if (player.time >= player.duration) player.isPlaying = false;
  }
  if (panels.some((panel) => panel.isStale)) {
    panels.forEach((panel) => panel.isStale && panel.draw(player.time));
    showBar();
    frames += 1;
  }
  requestAnimationFrame(frame);
}

matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  takeLook();
  fit();
});
new ResizeObserver(fit).observe(document.getElementById("panels"));
fit();
fromAddress(player);
requestAnimationFrame(frame);

// For scripts and tests: what is shown now.
window.roadgpt = {
  player,
  get frames() { return frames; },
  get poses() { return panels.map(({ pose }) => pose); },
  get others() { return scenes.map((scene) => (scene.others ? othersAt(scene, player.time) : [])); },
  get plates() { return panels.map(({ stage }) => stage && stage.plates); },
  get eyes() { return panels.map(({ stage }) => stage && stage.camera.position.toArray()); },
};
