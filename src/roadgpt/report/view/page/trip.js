// The trip along the road: the drive, or where nobody drove, a look along the right lane at an even pace.

const PACE = 50 / 3.6; // m/s of the look along a road that nobody drove

// Place on the road itself: x, y, z, heading at station s and offset t.
function onRoad(road, s, t) {
  const place = placeIn(road.s, s);
  const heading = read(road.heading, place);
  const grade = read(road.grade, place);
  const roll = road.lanes.bank ? read(road.lanes.bank, place) : 0;
  const pitch = Math.atan(grade);
  const [across, up] = [t * Math.cos(roll), t * Math.sin(roll)];
  const back = up * Math.sin(pitch);
  return {
    x: read(road.x, place) - across * Math.sin(heading) - back * Math.cos(heading),
    y: read(road.y, place) + across * Math.cos(heading) - back * Math.sin(heading),
    z: read(road.z, place) + up * Math.cos(pitch),
    grade, heading, roll,
  };
}

function driven(scene) {
  const columns = scene.drive.columns;
  const stations = risen(columns.s);
  return {
    isDriven: true,
    car: scene.drive.car,
    duration: columns.time[columns.time.length - 1],
    at(time) {
      const place = placeIn(columns.time, time);
      const pose = {};
      for (const name of Object.keys(columns)) pose[name] = read(columns[name], place);
      return pose;
    },
    timeAt(s) {
      const place = placeIn(stations, s);
      return read(columns.time, place);
    },
    nearest(x, y) {
      let best = Infinity;
      let found = 0;
      for (let i = 0; i < columns.x.length; i++) {
        const away = (columns.x[i] - x) ** 2 + (columns.y[i] - y) ** 2;
        if (away < best) { best = away; found = i; }
      }
      return columns.time[found];
    },
  };
}

function imagined(scene) {
  const { road } = scene;
  return {
    isDriven: false,
    car: { length: 4.7, width: 1.86, ahead: 0, height: 0.56, lock: 0.6 },
    duration: road.length / PACE,
    at(time) {
      const s = clamp(time * PACE, 0, road.length);
      const t = offsetAt(road, road.lanes.middle, s);
      const place = onRoad(road, s, t);
      return {
        ...place, z: place.z + 0.56, pitch: Math.atan(place.grade), speed: PACE, steer: 0, throttle: 0, brake: 0,
        s, t, outside: 0, failed: 0, time,
      };
    },
    timeAt: (s) => clamp(s, 0, road.length) / PACE,
    nearest(x, y) {
      let best = Infinity;
      let found = 0;
      const steps = Math.ceil(road.length);
      for (let i = 0; i <= steps; i++) {
        const s = (road.length * i) / steps;
        const place = onRoad(road, s, 0);
        const away = (place.x - x) ** 2 + (place.y - y) ** 2;
        if (away < best) { best = away; found = s; }
      }
      return found / PACE;
    },
  };
}

const tripOf = (scene) => (scene.drive ? driven(scene) : imagined(scene));
