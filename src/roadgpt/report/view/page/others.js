// The others on the road, where they are at a time. A car is built as the tested one; the rest are a few solids.

const SLOWS = 0.5; // m/s^2, from which brake lights are on
const AROUND = 2; // samples before and after, between which speeds are compared
const STILL = 0.3; // m/s
const PAINTS = [0xaeb4bd, 0xe9ebee, 0x3c4148, 0x2f4a73, 0x8a9a8b, 0x6e5a4a]; // of cars, one after the other
const RUBBER = 0x1d1f23, METAL = 0x8d939b, DARK = 0x33373d, PANE = 0x2b3f4d, SKIN = 0xd9a066, WHITE = 0xf2f2ef, SIGNAL = 0xe8641b;
const RED = 0xc6252b, WOOD = 0xa9794a, FUR = 0x8a5a33, PAPER = 0xb98d5a, AMBER = 0xf0b429, DENIM = 0x34466b, LAMP = 0xfff3d0;

// Everybody who is there at a time, with the pose between two samples; samples are `step` seconds apart.
function othersAt(scene, time) {
  const { step, actors } = scene.others;
  return actors.flatMap((actor, number) => {
    const at = time / step - actor.first;
    const last = actor.x.length - 1;
    if (at < -1e-6 || at > last + 1e-6) return [];
    const i = Math.min(Math.max(0, Math.floor(at + 1e-6)), Math.max(0, last - 1));
    const place = { i, u: clamp(at - i, 0, 1) };
    const pose = {};
    for (const name of ["x", "y", "z", "heading", "speed"]) pose[name] = read(actor[name], place);
    const next = Math.min(i + 1, last);
    const way = Math.hypot(actor.x[next] - actor.x[i], actor.y[next] - actor.y[i]);
    const pitch = way > 0.05 ? Math.atan((actor.z[next] - actor.z[i]) / way) : 0;
    const [early, late] = [Math.max(0, i - AROUND), Math.min(last, i + AROUND)];
    const slows = (Math.abs(actor.speed[early]) - Math.abs(actor.speed[late])) / (step * Math.max(1, late - early)) > SLOWS;
    actor.way ??= wayOf(actor, step);
    const stands = Math.abs(pose.speed) < STILL && actor.way[last] > 1; // who never moved is parked
    return [{ ...pose, pitch, brake: slows || stands ? 1 : 0, roll: 0, steer: 0, s: read(actor.way, place), number, actor }];
  });
}

// How far somebody has come at each sample.
function wayOf({ speed }, step) {
  let far = 0;
  return speed.map((v, i) => (far += i ? step * 0.5 * (v + speed[i - 1]) : 0));
}

const paints = new Map();

function paintOf(colour) {
  if (!paints.has(colour)) paints.set(colour, new THREE.MeshLambertMaterial({ color: colour, side: THREE.DoubleSide }));
  return paints.get(colour);
}

function solid(shape, colour, x = 0, y = 0, z = 0) {
  const mesh = new THREE.Mesh(shape, colour.isMaterial ? colour : paintOf(colour));
  mesh.position.set(x, y, z);
  return mesh;
}

// A box that stands at height `up`.
const block = (long, wide, high, ahead, up, colour, aside = 0) =>
  solid(new THREE.BoxGeometry(long, wide, high), colour, ahead, aside, up + high / 2);

const ball = (radius, x, y, z, colour) => solid(new THREE.SphereGeometry(radius, 14, 10), colour, x, y, z);

// A rod between two points, thicker at its begin.
function rod(from, to, thick, colour, thin = thick) {
  const [a, b] = [new THREE.Vector3(...from), new THREE.Vector3(...to)];
  const mesh = solid(new THREE.CylinderGeometry(thin, thick, a.distanceTo(b), 8), colour);
  mesh.position.copy(a).lerp(b, 0.5);
  mesh.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), b.sub(a).normalize());
  return mesh;
}

// A body by its outline seen from the left: x, z and half the width there.
function hull(rim, colour) {
  const middle = [0, 1, 2].map((k) => rim.reduce((sum, point) => sum + point[k], 0) / rim.length);
  const at = ([x, z, half], side) => [x, side * half, z];
  const faces = rim.flatMap((a, i) => {
    const b = rim[(i + 1) % rim.length];
    const [la, lb, ra, rb] = [at(a, 1), at(b, 1), at(a, -1), at(b, -1)];
    return [la, lb, rb, la, rb, ra, la, lb, at(middle, 1), ra, rb, at(middle, -1)];
  });
  const shape = new THREE.BufferGeometry();
  shape.setAttribute("position", new THREE.Float32BufferAttribute(faces.flat(), 3));
  shape.computeVertexNormals();
  return solid(shape, colour);
}

// A pane on a hull from its lower to its upper edge.
function pane([x0, z0, half0], [x1, z1, half1], colour = PANE) {
  const long = Math.hypot(x1 - x0, z1 - z0);
  const [nx, nz] = [(0.03 * (z1 - z0)) / long, (-0.03 * (x1 - x0)) / long];
  return hull([[x0 + nx, z0 + nz, half0], [x1 + nx, z1 + nz, half1], [x1 - nx, z1 - nz, half1], [x0 - nx, z0 - nz, half0]], colour);
}

// What rolls; a hub with corners shows it.
function wheel(radius, x, y, wide = 0.26) {
  const group = new THREE.Group();
  group.add(solid(new THREE.CylinderGeometry(radius, radius, wide, 20), RUBBER), solid(new THREE.CylinderGeometry(0.55 * radius, 0.55 * radius, wide + 0.03, 5), METAL));
  group.position.set(x, y, radius);
  return { group, radius };
}

function thinWheel(radius, x, thick) {
  const group = new THREE.Group();
  const tyre = solid(new THREE.TorusGeometry(radius - thick, thick, 8, 28), RUBBER);
  tyre.rotation.x = Math.PI / 2;
  group.add(tyre);
  for (const turn of [0, 1, 2, 3]) {
    const spoke = block(2 * (radius - thick), 0.015, 0.02, 0, -0.01, METAL);
    spoke.rotation.y = (turn * Math.PI) / 4;
    group.add(spoke);
  }
  group.position.set(x, 0, radius);
  return { group, radius };
}

const axles = (places, radius, half) => places.flatMap((x) => [half, -half].map((y) => wheel(radius, x, y)));

// Arms and legs swing around a point; `phase` 1 or -1.
function limb(at, phase, swing, ...parts) {
  const group = new THREE.Group();
  group.position.set(...at);
  group.add(...parts);
  return { group, phase, swing };
}

// Somebody who sits: hips, shoulders and hands as x and z; legs swing as pedals move them.
function rider(hips, shoulders, hands, foot, colour, helmet, swing) {
  const [[hx, hz], [sx, sz], [ax, az]] = [hips, shoulders, hands];
  const knee = [(hx + foot[0]) / 2 + 0.2, (hz + foot[1]) / 2 + 0.1];
  const solids = [
    rod([hx, 0, hz - 0.04], [sx, 0, sz], 0.15, colour, 0.19), ball(0.13, sx + 0.1, 0, sz + 0.24, helmet), ball(0.09, sx + 0.15, 0, sz + 0.2, SKIN),
    ...[1, -1].map((side) => rod([sx, side * 0.2, sz - 0.03], [ax, side * 0.24, az], 0.055, colour)),
  ];
  const limbs = [1, -1].map((side) => limb(
    [hx, side * 0.1, hz], side, swing,
    rod([0, 0, 0], [knee[0] - hx, 0.02 * side, knee[1] - hz], 0.085, DENIM, 0.065), rod([knee[0] - hx, 0.02 * side, knee[1] - hz], [foot[0] - hx, 0.02 * side, foot[1] - hz], 0.065, DENIM, 0.05),
    block(0.24, 0.09, 0.07, foot[0] - hx + 0.06, foot[1] - hz - 0.06, RUBBER, 0.02 * side),
  ));
  return { solids, limbs, stride: 4 };
}

// Lamps at the rear corners.
const rears = (brakes, x, half, z, wide = 0.22, high = 0.12) => [half, -half].map((y) => block(0.06, wide, high, x, z, brakes, y));

// What is not a car, in the frame of the middle of its box on the ground.
const LOOKS = {
  truck({ length: l, width: w, height: h, colour, paint }, brakes) {
    const [front, half, cab] = [l / 2, w / 2, Math.min(2.3, 0.3 * l)];
    const nose = [[front - cab, 0.55, half], [front - cab, 0.86 * h, 0.94 * half], [front - 0.35, 0.86 * h, 0.92 * half], [front - 0.02, 0.5 * h, half], [front, 0.4, half]];
    const radius = 0.5;
    return {
      solids: [
        block(l - 0.5, 0.5 * w, 0.3, -0.2, 0.6, DARK), block(l - cab - 0.25, w, h - 1.05, -(cab + 0.25) / 2, 1.05, paint || WHITE),
        block(l - cab - 0.24, w + 0.02, 0.3, -(cab + 0.25) / 2, 1.3, paint ? WHITE : colour), hull(nose, paint || colour),
        pane([front - 0.03, 0.51 * h, 0.9 * half], [front - 0.3, 0.8 * h, 0.82 * half]), block(0.7, w + 0.02, 0.24 * h, front - 0.95, 0.53 * h, PANE),
        block(0.08, 0.8 * w, 0.5, front, 0.7, DARK), ...[half - 0.3, 0.3 - half].map((y) => block(0.06, 0.35, 0.16, front + 0.01, 0.6, LAMP, y)),
        block(0.08, w, 0.12, 0.05 - front, 0.55, DARK), ...rears(brakes, -front, half - 0.25, 0.75, 0.4, 0.16),
      ],
      wheels: axles([front - 1.35, -0.22 * l, -0.33 * l], radius, half - 0.16),
    };
  },
  bus({ length: l, width: w, height: h, paint }, brakes) {
    const [front, half, body_] = [l / 2, w / 2, paint || AMBER];
    const body = [[-front, 0.4, half], [-front, h - 0.15, 0.97 * half], [0.2 - front, h, 0.9 * half], [front - 0.4, h, 0.9 * half], [front - 0.1, h - 0.25, 0.97 * half], [front, 0.4, half]];
    const posts = Math.round(l / 1.6);
    return {
      solids: [
        hull(body, body_), block(l - 0.7, w + 0.02, 0.31 * h, -0.1, 0.5 * h, PANE),
        ...Array.from({ length: posts - 1 }, (_, n) => block(0.09, w + 0.04, 0.31 * h, -front + ((n + 1) * l) / posts, 0.5 * h, body_)),
        pane([front - 0.01, 0.33 * h, 0.92 * half], [front - 0.1, 0.84 * h, 0.9 * half]), pane([front - 0.09, 0.86 * h, 0.6 * half], [front - 0.12, 0.92 * h, 0.6 * half], DARK),
        ...[front - 0.9, -0.05 * l].map((x) => block(1.1, 0.03, 0.72 * h, x, 0.42, DARK, -half)), block(l - 0.2, w + 0.01, 0.1, 0, 0.42, DARK),
        ...[half - 0.3, 0.3 - half].map((y) => block(0.06, 0.4, 0.16, front + 0.01, 0.62, LAMP, y)), ...rears(brakes, -front, half - 0.2, 0.8, 0.24, 0.3),
        pane([-front, 0.84 * h, 0.85 * half], [-front, 0.55 * h, 0.85 * half]),
      ],
      wheels: axles([front - 2.6, 3.2 - front], 0.48, half - 0.14),
    };
  },
  van({ length: l, width: w, height: h, paint }, brakes) {
    const [front, half] = [l / 2, w / 2];
    const body = [
      [-front, 0.35, half], [-front, 0.95 * h, 0.94 * half], [0.12 - front, h, 0.86 * half], [front - 1.75, h, 0.86 * half], [front - 1.5, 0.95 * h, 0.88 * half],
      [front - 0.8, 0.56 * h, 0.95 * half], [front - 0.12, 0.44 * h, 0.92 * half], [front, 0.3 * h, 0.9 * half], [front, 0.3, 0.9 * half],
    ];
    return {
      solids: [
        hull(body, paint || WHITE), pane([front - 0.84, 0.585 * h, 0.88 * half], [front - 1.46, 0.93 * h, 0.8 * half]),
        hull([[front - 2.35, 0.58 * h, half + 0.01], [front - 2.35, 0.87 * h, 0.95 * half + 0.01], [front - 1.6, 0.87 * h, 0.95 * half], [front - 1.05, 0.58 * h, half + 0.01]], PANE),
        ...[0.25, -0.25].map((share) => pane([-front, 0.86 * h, 0.16 * w], [-front, 0.6 * h, 0.16 * w])).map((each, n) => { each.position.y = (n ? -0.24 : 0.24) * w; return each; }),
        block(l - 0.1, w + 0.02, 0.16, 0, 0.34, DARK), block(0.06, 0.5 * w, 0.2, front, 0.28 * h, DARK),
        ...[half - 0.25, 0.25 - half].map((y) => block(0.3, 0.3, 0.2, front - 0.16, 0.33 * h, LAMP, y)), ...rears(brakes, -front, half - 0.1, 0.9, 0.16, 0.5),
      ],
      wheels: axles([front - 1.0, 1.3 - front], 0.37, half - 0.12),
    };
  },
  motorcycle({ length: l, colour }, brakes) {
    const [radius, far] = [0.31, l / 2 - 0.31];
    const sat = rider([-0.3, 0.82], [0.02, 1.22], [0.5, 1.0], [-0.1, 0.36], DARK, colour, 0);
    return {
      ...sat,
      solids: [
        ...sat.solids, hull([[-0.15, 0.75, 0.13], [0.05, 0.95, 0.15], [0.4, 0.92, 0.13], [0.55, 0.75, 0.08], [0.2, 0.6, 0.14]], colour),
        hull([[-0.85, 0.86, 0.07], [-0.6, 0.82, 0.12], [-0.1, 0.8, 0.13], [-0.1, 0.68, 0.13], [-0.6, 0.7, 0.1]], DARK), block(0.5, 0.3, 0.35, 0.08, 0.26, METAL),
        ...[0.09, -0.09].flatMap((y) => [rod([far, y, radius], [0.52, y, 0.95], 0.03, METAL), rod([-far, y, radius], [-0.15, y, 0.42], 0.03, DARK)]),
        rod([0.5, -0.32, 1.02], [0.5, 0.32, 1.02], 0.02, DARK), rod([-0.75, -0.16, 0.38], [0, -0.16, 0.3], 0.05, METAL), ball(0.09, 0.64, 0, 0.86, LAMP),
        block(0.05, 0.16, 0.08, -0.88, 0.78, brakes),
      ],
      wheels: [far, -far].map((x) => thinWheel(radius, x, 0.08)),
    };
  },
  bicycle({ length: l, colour }, brakes) {
    const [radius, far] = [0.34, l / 2 - 0.34];
    const sat = rider([-0.24, 0.98], [0.1, 1.42], [0.42, 1.02], [-0.02, 0.26], WHITE, colour, 0.3);
    const [rear, front, crank, seat, head] = [[-far, 0, radius], [far, 0, radius], [-0.06, 0, 0.3], [-0.26, 0, 0.92], [0.38, 0, 0.9]];
    return {
      ...sat,
      solids: [
        ...sat.solids, ...[[rear, crank], [crank, seat], [seat, head], [crank, head], [rear, seat], [head, front]].map(([a, b]) => rod(a, b, 0.022, colour)),
        rod([0.42, -0.28, 1.02], [0.42, 0.28, 1.02], 0.018, DARK), rod(head, [0.42, 0, 1.02], 0.02, DARK), block(0.24, 0.14, 0.05, -0.27, 0.91, DARK),
        block(0.03, 0.06, 0.05, -0.36, 0.8, brakes),
      ],
      wheels: [far, -far].map((x) => thinWheel(radius, x, 0.025)),
    };
  },
  person({ width: w, height: h, colour }) {
    const isChild = h < 1.4;
    const [hip, neck, head] = [0.48 * h, 0.82 * h, isChild ? 0.1 * h : 0.075 * h];
    const [arm, trousers] = [0.42 * w, isChild ? SIGNAL : DENIM];
    return {
      solids: [
        hull([[-0.1 * h * 0.7, hip - 0.02, 0.3 * w], [-0.1 * h * 0.75, neck - 0.03, 0.38 * w], [0, neck, 0.16 * w], [0.07 * h, neck - 0.04, 0.38 * w], [0.06 * h, hip - 0.02, 0.3 * w]], colour),
        rod([0, 0, neck - 0.02], [0.01, 0, neck + 0.04], 0.05, SKIN), ball(head, 0.02, 0, h - head, SKIN), ball(head * 1.02, -0.02, 0, h - head + 0.02, FUR),
        ...(isChild ? [block(0.12, 0.5 * w, 0.22 * h, -0.14, 0.56 * h, AMBER)] : []),
      ],
      limbs: [1, -1].flatMap((side) => [
        limb([0, side * 0.17 * w, hip], side, 0.5, rod([0, 0, 0], [0, 0, 0.05 - hip], 0.045 * h, trousers, 0.03 * h), block(0.14 * h, 0.05 * h, 0.04 * h, 0.03 * h, -hip, RUBBER)),
        limb([0, side * arm, neck - 0.05], -side, 0.4, rod([0, 0, 0], [0.03, 0, -0.36 * h], 0.03 * h, colour, 0.022 * h), ball(0.03 * h, 0.03, 0, -0.38 * h, SKIN)),
      ]),
      stride: 0.8 * h,
    };
  },
  pickup({ length: l, width: w, height: h, colour }, brakes) {
    const [front, half, bed] = [l / 2, w / 2, 0.38 * l];
    const cabin = [
      [bed - front, 0.4, half], [bed - front, 0.92 * h, 0.8 * half], [bed - front + 0.2, h, 0.76 * half], [front - 2.1, h, 0.76 * half],
      [front - 1.35, 0.6 * h, 0.9 * half], [front - 0.1, 0.54 * h, 0.92 * half], [front, 0.35, 0.9 * half],
    ];
    return {
      solids: [
        hull(cabin, colour), block(bed, w, 0.14, bed / 2 - front, 0.45, DARK), block(0.08, w, 0.5, 0.04 - front, 0.45, colour),
        ...[half - 0.05, 0.05 - half].map((y) => block(bed, 0.1, 0.5, bed / 2 - front, 0.45, colour, y)),
        pane([front - 1.4, 0.62 * h, 0.84 * half], [front - 2.08, 0.95 * h, 0.74 * half]), block(0.04, 1.3 * half, 0.22 * h, bed - front, 0.68 * h, PANE), block(0.06, 0.5 * w, 0.2, front, 0.5, DARK),
        ...[half - 0.25, 0.25 - half].map((y) => block(0.2, 0.28, 0.16, front - 0.1, 0.75, LAMP, y)), ...rears(brakes, -front, half - 0.1, 0.65, 0.14, 0.3),
      ],
      wheels: axles([front - 1.0, 1.15 - front], 0.39, half - 0.12),
    };
  },
  tractor({ length: l, width: w, height: h, colour }, brakes) {
    const [front, half] = [l / 2, w / 2];
    return {
      solids: [
        block(0.45 * l, 0.36 * w, 0.3 * h, 0.25 * l, 0.3 * h, SIGNAL), block(0.38 * l, 0.5 * w, 0.42 * h, -0.2 * l, 0.5 * h, PANE), block(0.42 * l, 0.56 * w, 0.06 * h, -0.2 * l, 0.94 * h, colour),
        rod([0.2 * l, 0.1 * w, 0.6 * h], [0.2 * l, 0.1 * w, 0.85 * h], 0.05, DARK), ...rears(brakes, -0.4 * l, 0.3 * w, 0.5 * h),
        ...[0.12, -0.12].map((y) => block(0.05, 0.2, 0.14, front - 0.05, 0.45 * h, LAMP, y * w)),
      ],
      wheels: [...[half - 0.25, 0.25 - half].map((y) => wheel(0.28 * h, 0.9 - front, y, 0.5)), ...[half - 0.3, 0.3 - half].map((y) => wheel(0.2 * h, front - 0.7, y, 0.35))],
    };
  },
  e_scooter({ length: l, height: h, colour }, brakes) {
    const [far, deck] = [l / 2 - 0.11, 0.12];
    const stands = LOOKS.person({ width: 0.5, height: h - deck, colour });
    [...stands.solids, ...stands.limbs.map((limb) => limb.group)].forEach((part) => { part.position.z += deck; part.position.x -= 0.1; });
    return {
      ...stands, limbs: stands.limbs.map((limb) => ({ ...limb, swing: 0 })),
      solids: [
        ...stands.solids, block(0.75 * l, 0.16, 0.05, 0, 0.08, DARK), rod([far, 0, 0.11], [far - 0.12, 0, 1.05], 0.025, DARK),
        rod([far - 0.12, -0.22, 1.05], [far - 0.12, 0.22, 1.05], 0.018, DARK), block(0.03, 0.08, 0.05, -far - 0.08, 0.15, brakes), ball(0.04, far - 0.06, 0, 0.95, LAMP),
      ],
      wheels: [far, -far].map((x) => thinWheel(0.11, x, 0.03)),
    };
  },
  wheelchair({ width: w, height: h, colour }) {
    const sat = rider([-0.1, 0.5], [-0.05, 0.5 + 0.55 * (h - 0.5)], [0.2, 0.62], [0.4, 0.16], colour, FUR, 0);
    return {
      ...sat, solids: [...sat.solids, block(0.46, 0.46, 0.06, 0, 0.42, DARK), block(0.06, 0.46, 0.45, -0.26, 0.48, DARK), block(0.16, 0.4, 0.04, 0.42, 0.1, METAL)],
      wheels: [...[0.46 * w, -0.46 * w].map((y) => wheel(0.3, -0.1, y, 0.04)), ...[0.2, -0.2].map((y) => wheel(0.09, 0.35, y, 0.04))],
    };
  },
  pushchair({ length: l, width: w, height: h, colour }) {
    const walks = LOOKS.person({ width: w, height: h, colour });
    const behind = -0.3 * l;
    [...walks.solids, ...walks.limbs.map((limb) => limb.group)].forEach((part) => { part.position.x += behind; });
    return {
      ...walks,
      solids: [
        ...walks.solids, hull([[0.02 * l, 0.45, 0.22], [0.1 * l, 0.75, 0.24], [0.42 * l, 0.7, 0.22], [0.46 * l, 0.42, 0.18]], DENIM), hull([[0.02 * l, 0.72, 0.24], [0.06 * l, 1.0, 0.22], [0.24 * l, 0.95, 0.22], [0.22 * l, 0.72, 0.24]], DENIM),
        rod([0.06 * l, -0.2, 0.7], [-0.16 * l, -0.2, 1.05], 0.018, METAL), rod([0.06 * l, 0.2, 0.7], [-0.16 * l, 0.2, 1.05], 0.018, METAL), rod([-0.16 * l, -0.2, 1.05], [-0.16 * l, 0.2, 1.05], 0.02, DARK),
        ...[[0.08, 0.22], [0.08, -0.22], [0.42, 0.2], [0.42, -0.2]].map(([x, y]) => rod([x * l, y, 0.12], [0.25 * l, y, 0.5], 0.015, METAL)),
      ],
      wheels: [[0.08, 0.22], [0.08, -0.22], [0.42, 0.2], [0.42, -0.2]].map(([x, y]) => wheel(0.12, x * l, y, 0.05)),
    };
  },
  dog({ length: l, height: h }) {
    const legs = [[0.22 * l, 1], [0.22 * l, -1], [-0.3 * l, -1], [-0.3 * l, 1]];
    return {
      solids: [
        hull([[-0.38 * l, 0.5 * h, 0.08], [-0.36 * l, 0.82 * h, 0.1], [0.25 * l, 0.86 * h, 0.11], [0.28 * l, 0.48 * h, 0.1]], WOOD), rod([0.24 * l, 0, 0.78 * h], [0.34 * l, 0, 0.95 * h], 0.08, WOOD),
        ball(0.1, 0.38 * l, 0, 0.92 * h, WOOD), block(0.14, 0.09, 0.08, 0.46 * l, 0.8 * h, FUR), rod([-0.37 * l, 0, 0.78 * h], [-0.5 * l, 0, 0.98 * h], 0.02, WOOD),
      ],
      limbs: legs.map(([x, side], n) => limb([x, side * 0.07, 0.5 * h], n % 2 ? 1 : -1, 0.4, rod([0, 0, 0.03], [0, 0, -0.5 * h], 0.04, WOOD, 0.025))),
      stride: 0.9,
    };
  },
  animal({ length: l, height: h }) {
    const [front, back, chest] = [0.24 * l, -0.34 * l, 0.56 * h];
    const legs = [[front, 1], [front, -1], [back, -1], [back, 1]];
    return {
      solids: [
        hull([[-0.45 * l, 0.62 * h, 0.09], [-0.4 * l, 0.76 * h, 0.14], [-0.1 * l, 0.75 * h, 0.16], [0.25 * l, 0.8 * h, 0.13], [0.32 * l, 0.66 * h, 0.1], [0.2 * l, 0.46 * h, 0.13], [-0.15 * l, 0.5 * h, 0.15], [-0.38 * l, 0.52 * h, 0.12]], FUR),
        rod([0.24 * l, 0, 0.72 * h], [0.37 * l, 0, 0.95 * h], 0.11, FUR, 0.07), hull([[0.33 * l, 0.9 * h, 0.06], [0.35 * l, 1.0 * h, 0.065], [0.41 * l, 0.98 * h, 0.05], [0.5 * l, 0.88 * h, 0.03], [0.49 * l, 0.85 * h, 0.03]], FUR),
        ball(0.03, 0.495 * l, 0, 0.87 * h, RUBBER), ball(0.06, -0.46 * l, 0, 0.68 * h, WHITE),
        ...[1, -1].flatMap((side) => [
          rod([0.36 * l, side * 0.04, 0.98 * h], [0.33 * l, side * 0.15, 1.05 * h], 0.035, FUR, 0.005), rod([0.37 * l, side * 0.03, 0.99 * h], [0.34 * l, side * 0.1, 1.2 * h], 0.014, WOOD),
          rod([0.355 * l, side * 0.065, 1.1 * h], [0.41 * l, side * 0.1, 1.2 * h], 0.012, WOOD),
        ]),
      ],
      limbs: legs.map(([x, side], n) => limb([x, side * 0.09, chest], n % 2 ? 1 : -1, 0.35, rod([0, 0, 0.03], [0, 0, 0.03 - chest], 0.06, FUR, 0.022))),
      stride: 1.6,
    };
  },
  cones({ length: l, width: w, height: h }) {
    const [n, m] = [l, w].map((size) => Math.max(1, Math.round(size / 1.2)));
    const solids = Array.from({ length: n * m }).flatMap((_, k) => {
      const [x, y] = [((k % n) + 0.5) * (l / n) - l / 2, (Math.floor(k / n) + 0.5) * (w / m) - w / 2];
      const ring = (low, high, colour) => rod([x, y, low * h], [x, y, high * h], 0.17 * (1.02 - low), colour, 0.17 * (1.02 - high));
      return [block(0.4, 0.4, 0.05 * h, x, 0, DARK, y), ring(0.05, 0.3, SIGNAL), ring(0.3, 0.5, WHITE), ring(0.5, 0.7, SIGNAL), ring(0.7, 0.84, WHITE), ring(0.84, 1, SIGNAL)];
    });
    return { solids };
  },
  barrier({ length: l, width: w, height: h }) {
    const count = Math.max(3, Math.round(w / 0.25));
    const boards = [0.42, 0.74].flatMap((low) => Array.from({ length: count }, (_, k) =>
      block(0.06, w / count, 0.22 * h, 0, low * h, k % 2 ? WHITE : RED, ((k + 0.5) / count - 0.5) * w)));
    const feet = [0.36, -0.36].flatMap((share) => [block(l, 0.1, 0.08, 0, 0, DARK, share * w), block(0.06, 0.06, h, 0, 0, METAL, share * w), ball(0.08, 0, share * w, h + 0.04, AMBER)]);
    return { solids: [...boards, ...feet] };
  },
  lost_load({ length: l, width: w, height: h }) {
    const [crate, box, plank] = [block(0.62 * l, 0.7 * w, 0.8 * h, -0.14 * l, 0, PAPER), block(0.36 * l, 0.4 * w, 0.5 * h, 0.3 * l, 0, WOOD, 0.2 * w), block(1.1 * l, 0.14, 0.04, 0, 0.82 * h, WOOD)];
    const tape = block(0.63 * l, 0.1, 0.81 * h, -0.14 * l, 0, WHITE);
    crate.rotation.z = tape.rotation.z = 0.3;
    box.rotation.z = -0.5;
    plank.rotation.set(0, 0.16, 0.7);
    return { solids: [crate, tape, box, plank] };
  },
};

// Blue lights on a roof.
const blueLights = ({ length, width, height, blue_light: isBlue }) => (isBlue
  ? [1, -1].map((side) => block(0.18, 0.3, 0.26, 0.06 * length, height - 0.16, new THREE.MeshBasicMaterial({ color: 0x2a6bff }), side * 0.25 * width)) : []);

function makeActor(actor) {
  const own = new THREE.Group();
  const brakes = new THREE.MeshLambertMaterial({ color: 0x5a0f12 });
  const { solids, wheels = [], limbs = [], stride = 1 } = LOOKS[actor.look](actor, brakes);
  own.add(...solids, ...blueLights(actor), ...[...wheels, ...limbs].map((part) => part.group), shadow({ ...actor, ahead: 0, height: 0 }));
  own.rotation.order = "ZYX";
  return {
    group: own,
    show(pose, origin) {
      own.position.set(pose.x - origin.x, pose.y - origin.y, pose.z - origin.z);
      own.rotation.set(0, -pose.pitch, pose.heading);
      brakes.emissive.setRGB(pose.brake ? 1 : 0, 0, 0);
      for (const { group, radius } of wheels) group.rotation.y = (pose.s / radius) % (2 * Math.PI);
      const pace = Math.min(1, Math.abs(pose.speed) / 1.2);
      for (const { group, phase, swing } of limbs) group.rotation.y = phase * swing * pace * Math.sin((2 * Math.PI * pose.s) / stride);
    },
  };
}

const RING = 2.3, BURST = 0.5, SHOWN = 3; // m; s that the flash lasts; s before a contact, from which its place is marked

// Where the tested car touched somebody: a ring on the road, and a flash at the moment.
function makeContact({ time, x, y, z }) {
  const group = new THREE.Group();
  const look = new THREE.MeshBasicMaterial({ color: MARK, transparent: true, depthTest: false });
  const paint = new THREE.MeshBasicMaterial({ color: MARK, transparent: true });
  const ring = solid(new THREE.TorusGeometry(RING, 0.09, 8, 48), paint, 0, 0, 0.1);
  const flash = new THREE.Group();
  for (let n = 0; n < 8; n++) {
    const [c, s] = [Math.cos((n * Math.PI) / 4), Math.sin((n * Math.PI) / 4)];
    flash.add(rod([0.35 * c, 0.35 * s, 0.8], [1.3 * c, 1.3 * s, 0.8 + 0.4 * (n % 2)], 0.13, look, 0.01));
  }
  group.add(ring, flash);
  group.renderOrder = 5;
  return {
    group,
    show(now, origin) {
      const since = now - time;
      group.visible = since > -SHOWN;
      group.position.set(x - origin.x, y - origin.y, z - origin.z);
      paint.opacity = since < 0 ? 0.2 : 0.95;
      flash.visible = since >= -1e-3 && since < BURST;
      flash.scale.setScalar(0.6 + clamp(since / BURST, 0, 1));
    },
  };
}

function makeOthers(scene) {
  const group = new THREE.Group();
  const made = scene.others.actors.map((actor, n) => {
    if (actor.look !== "car") return makeActor(actor);
    const car = makeCar({ ...actor, ahead: 0, height: 0, tall: actor.height / 1.5 }, actor.paint || PAINTS[n % PAINTS.length]);
    if (actor.blue_light) car.group.add(...blueLights(actor));
    return car;
  });
  const contacts = scene.others.contacts.map(makeContact);
  [...made, ...contacts].forEach((each) => group.add(each.group));
  return {
    group,
    show(time, origin) {
      made.forEach((each) => { each.group.visible = false; });
      for (const pose of othersAt(scene, time)) {
        made[pose.number].group.visible = true;
        made[pose.number].show(pose, origin, null);
      }
      contacts.forEach((each) => each.show(time, origin));
    },
  };
}

// On the plan: to scale, nowhere smaller than some pixels; vehicles have a nose, persons and animals are round.
function paintOthers(pen, scene, time, px, py, scale) {
  for (const { x, y, heading, brake, actor } of othersAt(scene, time)) {
    const [long, wide] = [Math.max(6, actor.length * scale) / 2, Math.max(3.5, actor.width * scale) / 2];
    pen.save();
    pen.translate(px(x), py(y));
    pen.rotate(-heading);
    pen.beginPath();
    if (["person", "animal"].includes(actor.group)) pen.ellipse(0, 0, long, Math.max(wide, 3), 0, 0, 7);
    else if (actor.group === "thing") pen.rect(-long, -wide, 2 * long, 2 * wide);
    else [[-1, -1], [0.6, -1], [1, 0], [0.6, 1], [-1, 1]].forEach(([u, v]) => pen.lineTo(u * long, v * wide));
    pen.closePath();
    pen.fillStyle = actor.colour;
    pen.strokeStyle = "#fff";
    pen.lineWidth = 2;
    pen.stroke();
    pen.fill();
    if (brake && actor.lamps) {
      pen.fillStyle = "#ff2a1f";
      pen.fillRect(-long - 1, -wide, 2.5, 2 * wide);
    }
    pen.restore();
  }
  for (const contact of scene.others.contacts) if (time > contact.time - SHOWN) star(pen, px(contact.x), py(contact.y), 8);
}

function star(pen, x, y, size) {
  pen.beginPath();
  for (let n = 0; n < 16; n++) {
    const [far, turn] = [n % 2 ? 0.45 * size : size, (n * Math.PI) / 8];
    pen.lineTo(x + far * Math.cos(turn), y + far * Math.sin(turn));
  }
  pen.closePath();
  pen.fillStyle = MARK;
  pen.strokeStyle = "#fff";
  pen.lineWidth = 1.5;
  pen.stroke();
  pen.fill();
}

// Until the boxes touch if everybody goes on evenly, the smallest of all, over time; and the smallest time to collision.
function closenessOf(scene, trip) {
  const { step, actors, near: { conflict, ttc, who, critical } } = scene.others;
  const at = (pose) => clamp(Math.round(pose.time / step), 0, conflict.length - 1);
  return {
    base: { length: trip.duration, of: (pose) => Math.min(pose.time, trip.duration), timeAt: (time) => time },
    s: conflict.map((_, n) => n * step), values: conflict, thin: ttc, floor: 0, ceiling: MOST_TIME,
    limit: { value: critical, name: `critical ${critical} s` },
    colour: (i) => (Math.min(conflict[i], conflict[i - 1]) < critical ? MARK : LOOK.here),
    marks: scene.places.filter(({ time }) => time !== null).map(({ time, ...place }) => ({ ...place, s: time })),
    contacts: scene.others.contacts.map(({ time }) => time),
    at: (pose) => conflict[at(pose)],
    tell(pose) {
      const now = conflict[at(pose)];
      return now === null ? "no conflict" : `${now.toFixed(1)} s to ${actors[who[at(pose)]].name}`;
    },
  };
}

const MOST_TIME = 5; // s, the top of the time line
