// The bar below, the keys, and what the address says after its #.

const RATES = [0.25, 0.5, 1, 2, 4, 8];
const THUMB = 16; // pixels, of the slider

function wireBar(player) {
  const byId = (id) => document.getElementById(id);
  const [slider, rate] = [byId("slider"), byId("rate")];
  slider.max = String(player.duration);
  for (const { time, colour } of player.marks) {
    const tick = document.createElement("i");
    tick.style.left = `calc(${THUMB / 2}px + ${time / player.duration} * (100% - ${THUMB}px))`;
    tick.style.background = colour;
    slider.parentElement.append(tick);
  }
  for (const time of player.contacts.slice(0, 1)) {
    const name = document.createElement("b");
    name.textContent = "contact";
    name.style.left = `calc(${THUMB / 2}px + ${time / player.duration} * (100% - ${THUMB}px))`;
    slider.parentElement.append(name);
    const button = document.createElement("button");
    Object.assign(button, { type: "button", className: "contact", title: "To the moment of contact (C)", textContent: "Contact" });
    button.addEventListener("click", () => player.toContact());
    document.querySelector(".bar .name").before(button);
  }
  slider.addEventListener("input", () => player.moveTo(Number(slider.value)));
  byId("play").addEventListener("click", () => player.toggle());
  rate.addEventListener("change", () => player.setRate(Number(rate.value)));
  const buttons = [...document.querySelectorAll("[data-camera]")];
  for (const button of buttons) button.addEventListener("click", () => player.choose(button.dataset.camera));
  wireKeys(player);
  return () => {
    slider.value = String(player.time);
    slider.setAttribute("aria-valuetext", player.clock());
    byId("clock").textContent = player.clock();
    byId("bar").classList.toggle("playing", player.isPlaying);
    byId("play").setAttribute("aria-label", player.isPlaying ? "Pause" : "Play");
    rate.value = String(player.rate);
    for (const button of buttons) button.setAttribute("aria-checked", String(button.dataset.camera === player.camera));
  };
}

function wireKeys(player) {
  const keys = document.getElementById("keys");
  const faster = (turn) => {
    player.setRate(RATES[clamp(RATES.indexOf(player.rate) + turn, 0, RATES.length - 1)]);
  };
  const acts = {
    " ": () => player.toggle(),
    ArrowLeft: (event) => player.moveTo(player.time - (event.shiftKey ? 0.1 : 1)),
    ArrowRight: (event) => player.moveTo(player.time + (event.shiftKey ? 0.1 : 1)),
    Home: () => player.moveTo(0),
    End: () => player.moveTo(player.duration),
    "[": () => faster(-1),
    "]": () => faster(1),
    1: () => player.choose("behind"),
    2: () => player.choose("bonnet"),
    3: () => player.choose("free"),
    f: () => player.toCar(),
    n: () => player.toMark(),
    c: () => player.toContact(),
    l: () => player.toggleLine(),
    "?": () => { keys.open = !keys.open; },
    Escape: () => { keys.open = false; },
  };
  document.addEventListener("keydown", (event) => {
    const act = acts[event.key] || acts[event.key.toLowerCase()];
    const isTyping = event.target instanceof HTMLSelectElement;
    const isPressing = event.key === " " && event.target.closest && event.target.closest("button, summary");
    if (!act || isTyping || isPressing || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    act(event);
  });
  document.addEventListener("pointerdown", (event) => {
    if (keys.open && !keys.contains(event.target)) keys.open = false;
  });
}

// #t=12.5&camera=bonnet opens the page there.
function fromAddress(player) {
  const asked = new URLSearchParams(location.hash.slice(1));
  const time = Number(asked.get("t"));
  if (CAMERAS.includes(asked.get("camera"))) player.choose(asked.get("camera"));
  if (Number.isFinite(time)) player.moveTo(time);
}
