// The others on the road, where they are at a time. A car is built as the tested one; the rest are a few solids.

const SLOWS = 0.7; // m/s^2, from which brake lights are on
const SILVER = 0xaeb4bd, RUBBER = 0x22252b, GLASS = 0x2f4a5c, SKIN = 0xd9a066;

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
    const brake = (actor.speed[i] - actor.speed[next]) / step > SLOWS ? 1 : 0;
    return [{ ...pose, pitch, brake, roll: 0, steer: 0, s: pose.speed * time, number, actor }];
  });
}

function block(long, wide, high, ahead, up, colour) {
  const shape = new THREE.Mesh(new THREE.BoxGeometry(long, wide, high), new THREE.MeshLambertMaterial({ color: colour }));
  shape.position.set(ahead, 0, up + high / 2);
  return shape;
}

function wheel(radius, ahead, wide) {
  const shape = new THREE.Mesh(new THREE.CylinderGeometry(radius, radius, wide, 20), new THREE.MeshLambertMaterial({ color: RUBBER }));
  shape.position.set(ahead, 0, radius);
  return shape;
}

// What is not a car, in the frame of the middle of its box on the ground.
function solidsOf({ kind, length, width, height, colour }) {
  if (kind === "truck") {
    const cab = Math.min(2.4, 0.3 * length);
    return [
      block(length - cab - 0.4, width, height - 1, -(cab + 0.4) / 2, 1, colour), block(cab, width, 0.75 * height, (length - cab) / 2, 0.5, colour),
      block(0.1, width * 0.9, 0.25 * height, length / 2, 0.5 * height, GLASS), ...[0.36, -0.2, -0.36].map((share) => wheel(0.5, share * length, width)),
    ];
  }
  if (kind === "van" || kind === "bus") {
    return [
      block(length, width, height - 0.35, 0, 0.35, colour), block(length * 0.94, width + 0.02, 0.28 * height, 0.02 * length, 0.55 * height, GLASS),
      ...[0.3, -0.3].map((share) => wheel(0.4, share * length, width + 0.04)),
    ];
  }
  if (kind === "motorcycle" || kind === "bicycle") {
    const radius = Math.min(0.34, 0.18 * length);
    return [
      wheel(radius, length / 2 - radius, 0.1), wheel(radius, radius - length / 2, 0.1), block(0.55 * length, 0.16, 0.3, 0, radius, colour),
      block(0.35, 0.45, 0.6, -0.1, 0.75, colour), block(0.24, 0.24, 0.26, -0.05, 1.36, SKIN),
    ];
  }
  if (kind === "adult" || kind === "child") {
    return [
      block(0.3 * length + 0.1, 0.7 * width, 0.48 * height, 0, 0, RUBBER), block(0.4 * length + 0.1, width, 0.36 * height, 0, 0.48 * height, colour),
      block(0.22, 0.2, 0.14 * height, 0, 0.86 * height, SKIN),
    ];
  }
  return [block(length, width, height, 0, 0, colour)];
}

function makeOthers(scene) {
  const group = new THREE.Group();
  const made = scene.others.actors.map((actor) => {
    if (actor.kind === "car") return makeCar({ ...actor, ahead: 0, height: 0 }, SILVER);
    const own = new THREE.Group();
    own.add(...solidsOf(actor), shadow({ ...actor, ahead: 0, height: 0 }));
    own.rotation.order = "ZYX";
    return {
      group: own,
      show(pose, origin) {
        own.position.set(pose.x - origin.x, pose.y - origin.y, pose.z - origin.z);
        own.rotation.set(0, -pose.pitch, pose.heading);
      },
    };
  });
  made.forEach((each) => group.add(each.group));
  return {
    group,
    show(time, origin) {
      made.forEach((each) => { each.group.visible = false; });
      for (const pose of othersAt(scene, time)) {
        made[pose.number].group.visible = true;
        made[pose.number].show(pose, origin, null);
      }
    },
  };
}

// On the plan: boxes to scale, nowhere smaller than some pixels.
function paintOthers(pen, scene, time, px, py, scale) {
  for (const { x, y, heading, actor } of othersAt(scene, time)) {
    const [long, wide] = [Math.max(5, actor.length * scale), Math.max(3, actor.width * scale)];
    pen.save();
    pen.translate(px(x), py(y));
    pen.rotate(-heading);
    pen.fillStyle = actor.colour;
    pen.strokeStyle = "#fff";
    pen.lineWidth = 1;
    pen.strokeRect(-long / 2, -wide / 2, long, wide);
    pen.fillRect(-long / 2, -wide / 2, long, wide);
    pen.restore();
  }
}
