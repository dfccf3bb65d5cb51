// A strip: one quantity over the distance along the road, with the car on it.

const LEFT = 34, RIGHT = 12, TOP = 26, BOTTOM = 20; // pixels around the graph
const NAMED = 16; // pixels at the top of the graph for the names of junctions
const NARROW = 200; // pixels, below which a value has no room beside its name for more than itself

// what: s, values, null where there is none; thin: values of a thin line; least: span of the axis; floor, ceiling:
// where it begins and ends; limit: a line with a name; colour: of the line at index i; at: value under the car;
// base: what the values stand over, if not the distance; marks: what is marked, if not the places of the scene.
function makeStrip(canvas, scene, trip, what, moveTo) {
  const { road } = scene;
  const base = what.base || { length: road.length, of: (pose) => clamp(pose.s, 0, road.length), timeAt: trip.timeAt };
  const view = { low: 0, high: 1, wide: 1, tall: 1 };
  const px = (s) => LEFT + (s / base.length) * view.wide;
  const py = (value) => TOP + view.tall * (1 - (value - view.low) / (view.high - view.low));

  function aim({ wide, high }) {
    const limits = what.limit ? [what.limit.value] : [];
    let [low, top] = extent([...extent(what.values), ...limits], what.least);
    const air = (top - low) * 0.08;
    low = what.floor === undefined ? low - air : what.floor;
    const tall = Math.max(1, high - TOP - BOTTOM);
    const hasNames = what.names && scene.network && scene.network.stretches.length > 0 && tall > 2 * NAMED;
    const above = hasNames ? Math.max(air, ((top - low) * NAMED) / (tall - NAMED)) : air;
    Object.assign(view, { low, high: what.ceiling ?? top + above, wide: Math.max(1, wide - LEFT - RIGHT), tall });
  }

  function axes(pen, { high }) {
    pen.lineWidth = 1;
    const up = tidyStep(view.high - view.low, Math.max(2, view.tall / 30));
    for (let value = Math.ceil(view.low / up) * up; value <= view.high; value += up) {
      rule(pen, LEFT, py(value), LEFT + view.wide, py(value));
      said(pen, String(+value.toFixed(6)), LEFT - 5, py(value), "right", LOOK.soft);
    }
    const along = tidyStep(base.length, Math.max(2, view.wide / 62));
    for (let s = 0; s <= base.length * 1.0001; s += along) {
      rule(pen, px(s), TOP, px(s), TOP + view.tall);
      said(pen, String(+s.toFixed(6)), px(s), high - BOTTOM / 2 - 1, "center", LOOK.soft);
    }
  }

  function rule(pen, x0, y0, x1, y1) {
    pen.strokeStyle = LOOK.rule;
    pen.lineWidth = 1;
    pen.beginPath();
    pen.moveTo(x0, y0);
    pen.lineTo(x1, y1);
    pen.stroke();
  }

  // Where the route is inside junctions; their names stand where there is room.
  function stretches(pen) {
    let free = LEFT;
    for (const { from, to, name } of scene.network ? scene.network.stretches : []) {
      pen.globalAlpha = 0.55;
      pen.fillStyle = LOOK.rule;
      pen.fillRect(px(from), TOP, px(to) - px(from), view.tall);
      pen.globalAlpha = 1;
      const half = what.names ? pen.measureText(name).width / 2 : Infinity;
      const middle = clamp(px((from + to) / 2), LEFT + half, LEFT + view.wide - half);
      if (middle - half < free) continue;
      said(pen, name, middle, TOP + 7, "center", LOOK.soft);
      free = middle + half + 6;
    }
  }

  // Where the car was outside its lane, in the colour of how far.
  function outside(pen) {
    if (!scene.drive) return;
    const { s, outside: share, failed } = scene.drive.columns;
    const colourAt = (i) => severeColour(scene, { outside: share[i], failed: failed[i] });
    pen.globalAlpha = 0.3;
    for (let i = 1, from = 0; i < s.length; i++) {
      const colour = colourAt(i);
      if (i + 1 < s.length && colourAt(i + 1) === colour) continue;
      if (colour) {
        pen.fillStyle = colour;
        pen.fillRect(px(s[from]), TOP, Math.max(1, px(s[i]) - px(s[from])), view.tall);
      }
      from = i;
    }
    pen.globalAlpha = 1;
  }

  function ground(pen, size) {
    aim(size);
    axes(pen, size);
    if (!what.base) {
      stretches(pen);
      outside(pen);
    }
    pen.save();
    pen.beginPath();
    pen.rect(LEFT - 3, TOP - 3, view.wide + 6, view.tall + 6);
    pen.clip();
    pen.lineJoin = "round";
    if (what.fill) {
      pen.beginPath();
      pen.moveTo(px(what.s[0]), py(view.low));
      what.s.forEach((s, i) => pen.lineTo(px(s), py(what.values[i])));
      pen.lineTo(px(what.s[what.s.length - 1]), py(view.low));
      pen.fillStyle = LOOK[what.fill];
      pen.fill();
    }
    // the case is seen by night only: the colours of low speeds are dark
    for (const [width, colour, values] of [[1.2, () => LOOK.soft, what.thin || []], [4, () => LOOK.case, what.values], [2.2, what.colour, what.values]]) {
      for (let i = 1; i < values.length; i++) {
        if (values[i - 1] === null || values[i] === null) continue;
        pen.beginPath();
        pen.moveTo(px(what.s[i - 1]), py(values[i - 1]));
        pen.lineTo(px(what.s[i]), py(values[i]));
        pen.strokeStyle = colour(i);
        pen.lineWidth = width;
        pen.lineCap = "round";
        pen.stroke();
      }
    }
    pen.restore();
    if (what.limit) {
      pen.setLineDash([5, 4]);
      pen.strokeStyle = LOOK.soft;
      pen.lineWidth = 1;
      pen.beginPath();
      pen.moveTo(LEFT, py(what.limit.value));
      pen.lineTo(LEFT + view.wide, py(what.limit.value));
      pen.stroke();
      pen.setLineDash([]);
      said(pen, what.limit.name, LEFT + view.wide - 2, py(what.limit.value) + 12, "right", LOOK.soft);
    }
    const level = what.names ? TOP + view.tall - 6 : TOP + 5; // names of junctions are at the top
    for (const place of what.marks || scene.places) cross(pen, px(clamp(place.s, 0, base.length)), level, place.isMinor ? 2.8 : 4, place.colour);
    for (const time of what.contacts || []) star(pen, px(time), TOP + view.tall - 8, 7);
  }

  function over(pen, size, pose) {
    const s = base.of(pose);
    const value = what.at(pose);
    pen.strokeStyle = LOOK.here;
    pen.lineWidth = 1.5;
    pen.beginPath();
    pen.moveTo(px(s), TOP);
    pen.lineTo(px(s), TOP + view.tall);
    pen.stroke();
    if (value !== null) {
      pen.beginPath();
      pen.arc(px(s), py(Math.min(value, view.high)), 5, 0, 7);
      pen.fillStyle = LOOK.here;
      pen.fill();
      pen.strokeStyle = "#fff";
      pen.lineWidth = 1.5;
      pen.stroke();
    }
    const text = what.tell(pose);
    said(pen, size.wide < NARROW ? text.split(",")[0] : text, size.wide - RIGHT + 2, 12, "right", LOOK.ink);
  }

  takesHold(canvas, (u) => moveTo(base.timeAt(clamp(((u - LEFT) / view.wide) * base.length, 0, base.length))));
  return makeSheet(canvas, ground, over);
}

function heightOf(scene) {
  const { road } = scene;
  return {
    s: road.s, values: road.z, least: 4, fill: "earth", names: true,
    colour: () => LOOK.surface,
    at: (pose) => read(road.z, placeIn(road.s, pose.s)),
    tell(pose) {
      const grade = 100 * read(road.grade, placeIn(road.s, pose.s));
      const slope = Math.abs(grade) < 0.05 ? "level" : `${grade > 0 ? "up" : "down"} ${Math.abs(grade).toFixed(1)} %`;
      return `${read(road.z, placeIn(road.s, pose.s)).toFixed(1)} m, ${slope}`;
    },
  };
}

function speedOf(scene, fastest) {
  const { columns } = scene.drive;
  const limit = kmh(scene.world.speed_limit);
  return {
    s: columns.s, values: columns.speed.map(kmh), least: 10, floor: 0,
    limit: { value: limit, name: `limit ${Math.round(limit)}` },
    colour: (i) => css(speedColour(columns.speed[i] / fastest)),
    at: (pose) => kmh(pose.speed),
    tell: (pose) => `${kmh(pose.speed).toFixed(0)} km/h`,
  };
}

function bendOf(scene) {
  const { road } = scene;
  const curvature = road.curvature.map((value) => 100 * value);
  return {
    s: road.s, values: curvature, least: 2,
    colour: () => LOOK.bend,
    at: (pose) => read(curvature, placeIn(road.s, pose.s)),
    tell(pose) {
      const bend = read(road.curvature, placeIn(road.s, pose.s));
      return Math.abs(bend) < 1 / 2000 ? "straight" : `radius ${Math.round(1 / Math.abs(bend))} m to the ${bend > 0 ? "left" : "right"}`;
    },
  };
}
