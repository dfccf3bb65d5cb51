// The road from above, north up and to scale.

const EDGE = 3; // pixels, from a text to the border
const GRID = [25, 50, 100, 250, 500, 1000, 2500, 5000, 10000]; // m between the lines on the plan

// A canvas that is sharp on every screen: paints a ground that lasts, and what moves over it.
function makeSheet(canvas, paintGround, paintOver) {
  const ground = document.createElement("canvas");
  const pen = canvas.getContext("2d");
  const size = { wide: 0, high: 0 };
  return {
    size,
    fit() {
      const ratio = Math.min(2, window.devicePixelRatio || 1);
      size.wide = canvas.clientWidth;
      size.high = canvas.clientHeight;
      for (const each of [canvas, ground]) {
        each.width = Math.max(1, Math.round(size.wide * ratio));
        each.height = Math.max(1, Math.round(size.high * ratio));
      }
      const under = ground.getContext("2d");
      under.setTransform(ratio, 0, 0, ratio, 0, 0);
      pen.setTransform(ratio, 0, 0, ratio, 0, 0);
      if (size.wide > 20 && size.high > 20) paintGround(under, size);
    },
    draw(pose) {
      pen.clearRect(0, 0, size.wide, size.high);
      pen.drawImage(ground, 0, 0, size.wide, size.high);
      if (size.wide > 20 && size.high > 20) paintOver(pen, size, pose);
    },
  };
}

// Moves the car while the pointer is down.
function takesHold(canvas, move) {
  let isHeld = false;
  const tell = (event) => {
    const frame = canvas.getBoundingClientRect();
    move(event.clientX - frame.left, event.clientY - frame.top);
  };
  canvas.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    isHeld = true;
    if (event.isTrusted) canvas.setPointerCapture(event.pointerId);
    tell(event);
  });
  canvas.addEventListener("pointermove", (event) => isHeld && tell(event));
  for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, () => { isHeld = false; });
}

function makePlan(canvas, scene, trip, fastest, moveTo) {
  const { road, world } = scene;
  const columns = scene.drive && scene.drive.columns;
  const shown = (name) => [...roadsOf(scene).flatMap((each) => each[name]), ...(columns ? columns[name] : [])];
  const ends = [extent(shown("x"), 30), extent(shown("y"), 30)];
  const view = { scale: 1, x: 0, y: 0 };
  const px = (x) => (x - view.x) * view.scale;
  const py = (y) => (view.y - y) * view.scale;

  function aim({ wide, high }) {
    const rim = 26;
    const [w, h] = ends.map(([low, high_]) => high_ - low);
    view.scale = Math.min((wide - 2 * rim - 24) / w, (high - 2 * rim - 24) / h);
    view.x = (ends[0][0] + ends[0][1]) / 2 - wide / 2 / view.scale;
    view.y = (ends[1][0] + ends[1][1]) / 2 + (high + 4) / 2 / view.scale;
  }

  function trace(pen, xs, ys, style, width) {
    pen.beginPath();
    xs.forEach((x, i) => (i ? pen.lineTo(px(x), py(ys[i])) : pen.moveTo(px(x), py(ys[i]))));
    pen.strokeStyle = style;
    pen.lineWidth = width;
    pen.stroke();
  }

  // The points of a line beside the road.
  function along(t) {
    const points = road.s.map((s) => beside(road, s, offsetAt(road, t, s)));
    return [points.map(([x]) => x), points.map(([, y]) => y)];
  }

  // The surface between two lines, nowhere narrower than some pixels.
  function ribbon(pen, left, right, style, least) {
    const [[xs, ys], [xe, ye]] = [along(left), along(right)];
    trace(pen, road.x, road.y, style, least);
    pen.beginPath();
    xs.forEach((x, i) => (i ? pen.lineTo(px(x), py(ys[i])) : pen.moveTo(px(x), py(ys[i]))));
    for (let i = xe.length - 1; i >= 0; i--) pen.lineTo(px(xe[i]), py(ye[i]));
    pen.fillStyle = style;
    pen.fill();
  }

  function ground(pen, size) {
    aim(size);
    const { wide, high } = size;
    pen.fillStyle = LOOK.meadow;
    pen.fillRect(0, 0, wide, high);
    pen.lineWidth = 1;
    pen.strokeStyle = LOOK.grid;
    const step = GRID.find((each) => each * view.scale >= 26) || GRID[GRID.length - 1];
    pen.beginPath();
    for (let x = Math.ceil(view.x / step) * step; px(x) < wide; x += step) { pen.moveTo(px(x), 0); pen.lineTo(px(x), high); }
    for (let y = Math.floor(view.y / step) * step; py(y) < high; y -= step) { pen.moveTo(0, py(y)); pen.lineTo(wide, py(y)); }
    pen.stroke();
    pen.setLineDash([6, 4]);
    pen.strokeStyle = LOOK.map;
    pen.strokeRect(px(0), py(world.map_size), world.map_size * view.scale, world.map_size * view.scale);
    pen.setLineDash([]);
    pen.lineJoin = "round";
    if (scene.network) paintNetwork(pen, scene, px, py, view.scale);
    else single(pen);
    if (columns) path(pen);
    if (hasEnds(scene)) {
      label(pen, size, 0, "start", LOOK.paper);
      label(pen, size, road.length, isLoop(view.scale) ? "" : "goal", LOOK.ink);
    }
    scene.places.forEach((place) => cross(pen, px(place.x), py(place.y), place.isMinor ? 3.5 : 6, place.colour));
    scaleBar(pen, size, step);
  }

  function single(pen) {
    const { bounds, driven, rims } = road.lanes;
    ribbon(pen, rims.left, rims.right, LOOK.verge, 5);
    ribbon(pen, bounds[0].t, bounds[bounds.length - 1].t, LOOK.asphalt, 4);
    if (road.lanes.median) ribbon(pen, bounds[road.lanes.median.strip].t, bounds[road.lanes.median.strip + 1].t, LOOK.meadow, 1);
    const lane = (offsetAt(road, bounds[driven].t, 0) - offsetAt(road, bounds[driven + 1].t, 0)) * view.scale;
    if (lane > 3) bounds.slice(1, -1).forEach(({ t }) => trace(pen, ...along(t), "#fff", 0.8));
  }

  // Do both ends lie so near that their names would cover each other?
  const isLoop = (scale) => {
    const last = road.x.length - 1;
    return Math.hypot(road.x[0] - road.x[last], road.y[0] - road.y[last]) * scale < 50;
  };

  function path(pen) {
    const kept = spaced(columns, Math.max(0.25, 1.5 / view.scale));
    pen.lineCap = "round";
    for (const [width, isCase] of [[4, true], [2.4, false]]) {
      for (let n = 1; n < kept.length; n++) {
        const [a, b] = [kept[n - 1], kept[n]];
        pen.beginPath();
        pen.moveTo(px(columns.x[a]), py(columns.y[a]));
        pen.lineTo(px(columns.x[b]), py(columns.y[b]));
        pen.strokeStyle = isCase ? "#fff" : css(speedColour((columns.speed[a] + columns.speed[b]) / 2 / fastest));
        pen.lineWidth = width;
        pen.stroke();
      }
    }
    pen.lineCap = "butt";
  }

  function label(pen, { high }, s, text, fill) {
    const { x, y, heading } = onRoad(road, s, 0);
    const sign = s > 0 ? 1 : -1;
    pen.beginPath();
    pen.arc(px(x), py(y), 4, 0, 7);
    pen.fillStyle = fill;
    pen.fill();
    pen.strokeStyle = LOOK.ink;
    pen.lineWidth = 1.5;
    pen.stroke();
    const [u, v] = [px(x) + sign * Math.cos(heading) * 18, py(y) - sign * Math.sin(heading) * 14];
    said(pen, text, u, clamp(v, 26, high - 10), "center");
  }

  function scaleBar(pen, { wide }, step) {
    const long = step * view.scale;
    pen.strokeStyle = LOOK.ink;
    pen.lineWidth = 1.5;
    pen.beginPath();
    pen.moveTo(wide - 10 - long, 17);
    pen.lineTo(wide - 10 - long, 21);
    pen.lineTo(wide - 10, 21);
    pen.lineTo(wide - 10, 17);
    pen.stroke();
    said(pen, `${step} m`, wide - 10 - long / 2, 12, "center");
  }

  function over(pen, size, pose) {
    if (scene.others) paintOthers(pen, scene, pose.time, px, py, view.scale);
    pen.save();
    pen.translate(px(pose.x), py(pose.y));
    pen.rotate(-pose.heading);
    pen.beginPath();
    pen.moveTo(11, 0);
    pen.lineTo(-7, 6.5);
    pen.lineTo(-4, 0);
    pen.lineTo(-7, -6.5);
    pen.closePath();
    pen.fillStyle = (trip.isDriven && severeColour(scene, pose)) || HERE;
    pen.strokeStyle = "#fff";
    pen.lineWidth = 2;
    pen.stroke();
    pen.fill();
    pen.restore();
  }

  takesHold(canvas, (u, v) => moveTo(trip.nearest(view.x + u / view.scale, view.y - v / view.scale)));
  return makeSheet(canvas, ground, over);
}

// Writes a text, no part of it outside the sheet.
function said(pen, text, x, y, align, colour = LOOK.ink) {
  pen.font = "11px system-ui, sans-serif";
  pen.textAlign = align;
  pen.textBaseline = "middle";
  pen.lineWidth = 3;
  pen.strokeStyle = LOOK.halo;
  const wide = pen.measureText(text).width;
  const before = { left: 0, center: wide / 2, right: wide }[align];
  x = clamp(x, before + EDGE, pen.canvas.width / pen.getTransform().a - wide + before - EDGE);
  pen.strokeText(text, x, y);
  pen.fillStyle = colour;
  pen.fillText(text, x, y);
}

function cross(pen, x, y, r, colour = MARK) {
  const thick = r < 4 ? 0.7 : 1;
  for (const [style, width] of [["#fff", 5 * thick], [colour, 2.6 * thick]]) {
    pen.beginPath();
    pen.moveTo(x - r, y - r);
    pen.lineTo(x + r, y + r);
    pen.moveTo(x - r, y + r);
    pen.lineTo(x + r, y - r);
    pen.strokeStyle = style;
    pen.lineWidth = width;
    pen.lineCap = "round";
    pen.stroke();
    pen.lineCap = "butt";
  }
}
