// The car: that of films, in the frame of the simulated car's centre of gravity.

const SHADE = 0.5; // of the light that is lost under the car

// The hull, or the wheel around its hub: the triangles of one kind after the other, each kind of one material.
function partOf(isWheel, [x, y, z], materials) {
  const { points, corners, kinds, wheel } = SCENERY.car;
  const shape = new THREE.BufferGeometry();
  const places = inGroups(points, 3).flatMap((point) => [point[0] / 1000 - x, point[1] / 1000 - y, point[2] / 1000 - z]);
  const own = inGroups(corners, 3).map((each, n) => ({ each, kind: kinds[n] })).filter(({ each }) => each[0] >= wheel === isWheel);
  own.sort((a, b) => a.kind - b.kind);
  shape.setAttribute("position", new THREE.Float32BufferAttribute(places, 3));
  shape.setIndex(own.flatMap(({ each }) => each));
  for (const kind of new Set(own.map((each) => each.kind))) {
    const count = own.filter((each) => each.kind === kind).length;
    shape.addGroup(3 * own.findIndex((each) => each.kind === kind), 3 * count, kind);
  }
  shape.computeVertexNormals();
  return new THREE.Mesh(shape, materials);
}

function makeCar(size, colour = null) {
  const { car } = SCENERY;
  const group = new THREE.Group();
  const materials = SCENERY.plain.map((rgb, kind) => {
    const look = { color: new THREE.Color(...rgb), side: THREE.DoubleSide };
    if (!car.glossy.includes(kind)) return new THREE.MeshLambertMaterial(look);
    return new THREE.MeshStandardMaterial({ ...look, roughness: 0.35, metalness: 0.1 });
  });
  const body = partOf(false, [0, 0, 0], materials);
  const radius = car.hubs[0][2];
  const wheels = car.hubs.map(([x, y, z, steers]) => {
    const [turning, rolling] = [new THREE.Group(), partOf(true, car.hubs[0], materials)];
    turning.add(rolling);
    turning.position.set(x, y, z);
    turning.scale.y = Math.sign(y * car.hubs[0][1]);
    body.add(turning);
    return { turning, rolling, steers };
  });
  body.position.set(size.ahead, 0, -size.height);
  body.scale.set(size.length / car.length, size.width / car.width, size.tall || 1);
  group.add(body, shadow(size));
  group.rotation.order = "ZYX";
  const paint = materials[car.glossy[0]];
  if (colour !== null) paint.color.set(colour);
  const own = paint.color.clone();
  return {
    group,
    show(pose, origin, severe) {
      group.position.set(pose.x - origin.x, pose.y - origin.y, pose.z - origin.z);
      group.rotation.set(pose.roll, -pose.pitch, pose.heading);
      for (const { turning, rolling, steers } of wheels) {
        turning.rotation.z = steers ? pose.steer : 0;
        rolling.rotation.y = (pose.s / radius) % (2 * Math.PI);
      }
      paint.color.copy(severe ? colourOf(severe) : own);
      for (const [kind, light] of Object.entries(car.braking)) materials[kind].emissive.setRGB(...(pose.brake > 0.05 ? light : [0, 0, 0]));
    },
  };
}

// Soft: the picture of a blurred box.
function shadow(size) {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [128, 64];
  const pen = canvas.getContext("2d");
  pen.shadowBlur = 14;
  pen.shadowColor = "#000";
  pen.shadowOffsetX = 200;
  pen.fillRect(12 - 200, 12, 104, 40);
  const shape = new THREE.BufferGeometry();
  const [long, wide] = [size.length * 0.6, size.width * 0.72];
  const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]].flatMap(([x, y]) => [x * long + size.ahead, y * wide, 0.06 - size.height]);
  shape.setAttribute("position", new THREE.Float32BufferAttribute(corners, 3));
  shape.setAttribute("uv", new THREE.Float32BufferAttribute([0, 0, 1, 0, 1, 1, 0, 1], 2));
  shape.setIndex([0, 1, 2, 0, 2, 3]);
  const look = { map: new THREE.CanvasTexture(canvas), transparent: true, opacity: SHADE, depthWrite: false };
  return new THREE.Mesh(shape, new THREE.MeshBasicMaterial({ ...look, polygonOffset: true, polygonOffsetFactor: -6, polygonOffsetUnits: -6 }));
}

// Where nobody drove there is no car: an arrow over the lane says where the look is.
function makePointer() {
  const group = new THREE.Group();
  const paint = new THREE.MeshLambertMaterial({ color: 0x0072b2 });
  const tip = new THREE.Mesh(new THREE.ConeGeometry(0.45, 1.1, 32), paint);
  tip.rotation.x = -Math.PI / 2;
  tip.position.z = 1.1;
  const ring = new THREE.Mesh(new THREE.TorusGeometry(0.9, 0.06, 10, 48), paint);
  ring.position.z = 0.1;
  group.add(tip, ring);
  return {
    group,
    show(pose, origin) {
      group.position.set(pose.x - origin.x, pose.y - origin.y, pose.z - 0.56 - origin.z);
      group.rotation.z = pose.heading;
    },
  };
}
