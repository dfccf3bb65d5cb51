// The car: a plain saloon of the size that the simulator's car has, in the frame of its centre of gravity.

const PAINTED = 0x2f6db5, GLASS = 0x1d2733, TYRE = 0x17191c;
const WHEEL = 0.33, TYRE_WIDTH = 0.22; // m

const box = (l, w, h, x, y, z, material) => {
  const mesh = new THREE.Mesh(new THREE.BoxGeometry(l, w, h), material);
  mesh.position.set(x, y, z);
  return mesh;
};

// A silhouette [x, z] swept across the width, edges bevelled.
function swept(outline, width, bevel, material) {
  const shape = new THREE.Shape();
  outline.forEach(([x, z], i) => (i ? shape.lineTo(x, z) : shape.moveTo(x, z)));
  const geometry = new THREE.ExtrudeGeometry(shape, {
    depth: width - 2 * bevel, bevelEnabled: true, bevelThickness: bevel, bevelSize: bevel, bevelOffset: -bevel, bevelSegments: 2,
  });
  geometry.rotateX(Math.PI / 2);
  geometry.translate(0, width / 2 - bevel, 0);
  return new THREE.Mesh(geometry, material);
}

// The cabin narrows upwards: eight corners, windows all round, the roof painted.
function cabin(half, glass, paint) {
  const low = [[-0.36 * half * 2, 0.86], [0.235 * half * 2, 0.86]];
  const top = [[-0.235 * half * 2, 1.38], [0.06 * half * 2, 1.4]];
  const [wide, narrow] = [0.8, 0.6];
  const ring = ([a, b], w) => [[a[0], -w, a[1]], [b[0], -w, b[1]], [b[0], w, b[1]], [a[0], w, a[1]]];
  const points = [...ring(low, wide), ...ring(top, narrow)];
  const group = new THREE.Group();
  const faces = { glass: [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]], roof: [[4, 5, 6, 7]] };
  for (const [name, list] of Object.entries(faces)) {
    const geometry = new THREE.BufferGeometry();
    const corners = list.flatMap(([a, b, c, d]) => [a, b, c, a, c, d].flatMap((k) => points[k]));
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(corners, 3));
    geometry.computeVertexNormals();
    group.add(new THREE.Mesh(geometry, name === "glass" ? glass : paint));
  }
  return group;
}

function wheel(x, y, material, rim) {
  const turning = new THREE.Group();
  const rolling = new THREE.Group();
  const tyre = new THREE.Mesh(new THREE.CylinderGeometry(WHEEL, WHEEL, TYRE_WIDTH, 22), material);
  rolling.add(tyre);
  for (let k = 0; k < 5; k++) {
    const spoke = box(0.05, TYRE_WIDTH + 0.02, 0.44, 0, 0, 0, rim);
    spoke.rotation.y = (k * Math.PI) / 5;
    rolling.add(spoke);
  }
  turning.add(rolling);
  turning.position.set(x, y, WHEEL);
  return { turning, rolling };
}

function makeCar(size) {
  const group = new THREE.Group();
  const body = new THREE.Group();
  const paint = new THREE.MeshStandardMaterial({ color: PAINTED, roughness: 0.38, metalness: 0.15 });
  const glass = new THREE.MeshStandardMaterial({ color: GLASS, roughness: 0.15, metalness: 0.3 });
  const dark = new THREE.MeshLambertMaterial({ color: TYRE });
  const rim = new THREE.MeshLambertMaterial({ color: 0xaab0b7 });
  const lamp = new THREE.MeshBasicMaterial({ color: 0xf8f5e6 });
  const stop = new THREE.MeshBasicMaterial({ color: 0x7a1512 });
  const half = size.length / 2;
  const at = (share) => share * size.length;
  const sill = [[-half, 0.42], [-half + 0.06, 0.86], [at(-0.36), 0.93], [at(0.2), 0.92], [at(0.42), 0.78], [half, 0.62],
    [half, 0.3], [half - 0.15, 0.2], [-half + 0.2, 0.2]];
  body.add(swept(sill, size.width, 0.07, paint), cabin(half, glass, paint));
  body.add(box(0.1, size.width - 0.1, 0.16, -half + 0.06, 0, 0.36, dark), box(0.1, size.width - 0.1, 0.14, half - 0.06, 0, 0.34, dark));
  body.add(box(0.04, 0.52, 0.12, -half - 0.005, 0, 0.56, lamp));
  for (const side of [1, -1]) {
    body.add(box(0.1, 0.42, 0.13, half - 0.04, side * 0.64, 0.5, lamp));
    body.add(box(0.06, 0.4, 0.14, -half + 0.02, side * 0.65, 0.74, stop));
    body.add(box(0.16, 0.16, 0.1, at(0.17), side * (size.width / 2 + 0.06), 0.96, paint));
  }
  const wheels = [];
  for (const [x, isFront] of [[at(0.3), true], [at(-0.29), false]]) {
    for (const side of [1, -1]) {
      const made = wheel(x, side * (size.width / 2 - TYRE_WIDTH / 2 + 0.03), dark, rim);
      body.add(made.turning);
      wheels.push({ ...made, isFront });
    }
  }
  body.position.set(size.ahead, 0, -size.height);
  group.add(body, shadow(size));
  group.rotation.order = "ZYX";
  return {
    group,
    show(pose, origin, severe) {
      group.position.set(pose.x - origin.x, pose.y - origin.y, pose.z - origin.z);
      group.rotation.set(pose.roll, -pose.pitch, pose.heading);
      for (const { turning, rolling, isFront } of wheels) {
        turning.rotation.z = isFront ? pose.steer : 0;
        rolling.rotation.y = (pose.s / WHEEL) % (2 * Math.PI);
      }
      paint.color.set(severe || PAINTED);
      stop.color.setHex(pose.brake > 0.05 ? 0xff3020 : 0x7a1512);
    },
  };
}

function shadow(size) {
  const shape = new Shape3({ x: 0, y: 0, z: 0 });
  const [l, w] = [size.length / 2 - 0.02, size.width / 2 + 0.02];
  const black = colourOf(0);
  const z = -size.height + 0.06;
  const corners = [[-l, -w], [l, -w], [l, w], [-l, w]].map(([x, y]) => shape.point(x + size.ahead, y, z, black));
  shape.quad(...corners);
  return shape.mesh(THREE.MeshBasicMaterial, { transparent: true, opacity: 0.38, depthWrite: false, polygonOffset: true, polygonOffsetFactor: -6, polygonOffsetUnits: -6 });
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
