// Weather: haze, what falls, night and a low sun, as the cameras of drivers have them. A scene without has none of this.

const BRIGHT = 14; // m ahead of headlights, where the road is about as light as by day
const DIMMEST = 0.03; // share of daylight: at night one can still see where one is on the page
const RAIN_BOX = 24; // m around the camera in which drops are drawn

// Contrasts fall with the exponent of the distance (Koschmieder), not of its square as three.js has it.
Object.getPrototypeOf(THREE.MeshBasicMaterial.prototype).onBeforeCompile = (shader) => {
  shader.fragmentShader = shader.fragmentShader.replace("#include <fog_fragment>", `
    #if defined(USE_FOG) && defined(FOG_EXP2)
      gl_FragColor.rgb = mix(fogColor, gl_FragColor.rgb, exp(-fogDensity * vFogDepth));
    #else
      #include <fog_fragment>
    #endif`);
};

const spotted = (wide, stops) => {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = wide;
  const pen = canvas.getContext("2d");
  const blend = pen.createRadialGradient(wide / 2, wide / 2, 0, wide / 2, wide / 2, wide / 2);
  stops.forEach(([at, colour]) => blend.addColorStop(at, colour));
  pen.fillStyle = blend;
  pen.fillRect(0, 0, wide, wide);
  return new THREE.CanvasTexture(canvas);
};

function glow(size, stops, look) {
  const material = { map: spotted(256, stops), blending: THREE.AdditiveBlending, depthWrite: false, fog: false, transparent: true, ...look };
  const sprite = new THREE.Sprite(new THREE.SpriteMaterial(material));
  sprite.scale.set(size, size, 1);
  return sprite;
}

// Lamps that are seen from afar, in the frame of the middle of the box on the ground.
function lampsOf({ lamps: count, length, width }) {
  return [[1, "255,250,230"], [-1, "255,30,20"]].flatMap(([end, rgb]) => Array.from({ length: count }, (_, n) => {
    const lamp = glow(0.4, [[0, `rgba(${rgb},1)`], [0.25, `rgba(${rgb},.8)`], [1, `rgba(${rgb},0)`]], {});
    lamp.position.set(end * (length / 2 + 0.05), count > 1 ? (n - 0.5) * 0.8 * width : 0, 0.7);
    return lamp;
  }));
}

function headlights(car) {
  const beam = new THREE.SpotLight(new THREE.Color(1, 0.97, 0.9), 9 * BRIGHT ** 2, 0, 0.42, 0.9, 2);
  beam.position.set(car.ahead + car.length / 2, 0, 1.6 - car.height);
  beam.target.position.set(car.ahead + car.length / 2 + 26, 0, -car.height - 2);
  return [beam, beam.target];
}

// Drops in two equal boxes, one above the other, so that they fall without an end.
function streaks({ amount, length, colour }) {
  const lot = lotOf(7);
  const points = [];
  for (let n = 0; n < Math.min(2500, 350 * Math.sqrt(amount)); n++) {
    const [x, y, z] = [lot(), lot(), lot()].map((share, k) => RAIN_BOX * (k < 2 ? share - 0.5 : share));
    for (const up of [z, z + RAIN_BOX]) points.push(x, y, up, x, y, up + length);
  }
  const shape = new THREE.BufferGeometry();
  shape.setAttribute("position", new THREE.Float32BufferAttribute(points, 3));
  const look = { color: colour, transparent: true, opacity: 0.35, fog: false, depthWrite: false };
  const lines = new THREE.LineSegments(shape, new THREE.LineBasicMaterial(look));
  lines.frustumCulled = false;
  return lines;
}

// Changes the world of a stage, and returns what moves with the camera.
function makeWeather(scene, world, { dome, wood, lights: [ambient, direct], car, others }) {
  const { extinction, light, beam, sun, falls, haze } = scene.weather;
  const sky = Math.max(scene.weather.sky, DIMMEST);
  const tint = new THREE.Color(...light.map((share) => Math.max(share, DIMMEST)));
  for (const each of [ambient.color, ambient.groundColor, direct.color]) each.multiply(tint);
  wood.group.children[0].material.color.multiply(tint); // all trees have it
  dome.material.color.setScalar(sky);
  world.fog.color.multiplyScalar(sky);
  if (extinction > 0) {
    const grey = new THREE.Color(...haze.map((share) => (share / scene.weather.sky) * sky));
    world.fog = new THREE.FogExp2(grey, extinction);
    dome.material.map = null;
    dome.material.color.copy(grey);
  }
  if (beam) {
    const size = { ahead: 0, height: 0, ...(scene.drive ? scene.drive.car : { length: 4.7, width: 1.86, height: 0.56 }) };
    const lamps = lampsOf({ ...size, lamps: 2 }).slice(2); // its own headlights would dazzle
    lamps.forEach(({ position }) => position.set(position.x + size.ahead, position.y, position.z - size.height));
    car.group.add(...headlights(size), ...lamps);
    if (others) scene.others.actors.forEach((actor, n) => lampsOf(actor).forEach((lamp) => others.group.children[n].add(lamp)));
  }
  const way = new THREE.Vector3(...sun);
  const isLow = way.lengthSq() > 0;
  const disc = glow(0.5 * DOME, [[0, "#fff"], [0.05, "#fffbe8"], [0.08, "rgba(255,238,190,.5)"], [0.3, "rgba(255,214,140,.13)"], [1, "rgba(255,200,120,0)"]], {});
  const veil = glow(1.4 * DOME, [[0, "rgba(255,232,190,.4)"], [0.2, "rgba(255,226,180,.12)"], [1, "rgba(255,220,170,0)"]], { depthTest: false });
  const drops = falls.map(streaks);
  if (isLow) {
    direct.position.copy(way);
    world.add(disc, veil);
  }
  drops.forEach((each) => world.add(each));
  return {
    show(camera, away, time) {
      if (extinction > 0) world.fog.density = Math.log(20) / (Math.log(20) / extinction + 4 * away);
      for (const each of [disc, veil]) each.position.copy(camera.position).addScaledVector(way, 0.9 * DOME);
      veil.visible = camera.getWorldDirection(new THREE.Vector3()).dot(way) > 0;
      drops.forEach((each, n) => {
        each.position.copy(camera.position);
        each.position.z -= RAIN_BOX / 2 + ((falls[n].speed * time) % RAIN_BOX);
        each.visible = away === 0 || away < 60;
      });
    },
  };
}
