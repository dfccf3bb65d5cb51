// Grain of surfaces: small pictures of noise that repeat over the ground, the same in every browser.

const GRAIN_SIDE = 256; // pixels
const MEAN = 190; // of 255, mean level

// Numbers from 0 to 1, drawn from a seed (Marsaglia's xorshift, 32 bits).
function lotOf(seed) {
  let state = seed | 0;
  return () => {
    state ^= state << 13;
    state ^= state >>> 17;
    state ^= state << 5;
    return (state >>> 0) / 4294967296;
  };
}

// How light each pixel is; octaves of [cells along a side, strength], so that both near and far show grain.
function noiseOf(seed, octaves) {
  const side = GRAIN_SIDE;
  const out = new Float32Array(side * side).fill(1);
  const lot = lotOf(seed);
  for (const [cells, strength] of octaves) {
    const knots = Float32Array.from({ length: cells * cells }, () => lot() - 0.5);
    const knot = (i, j) => knots[(j % cells) * cells + (i % cells)];
    for (let y = 0; y < side; y++) {
      for (let x = 0; x < side; x++) {
        const [u, v] = [(x * cells) / side, (y * cells) / side];
        const [i, j] = [Math.floor(u), Math.floor(v)];
        const low = mix(knot(i, j), knot(i + 1, j), u - i);
        const high = mix(knot(i, j + 1), knot(i + 1, j + 1), u - i);
        out[y * side + x] += strength * mix(low, high, v - j);
      }
    }
  }
  return out;
}

// The look of a surface with grain: a texture that lies over so many metres of ground, and only makes the colours of
// the corners lighter or darker; its mean is made up for.
function grainOf(renderer, metres, seed, octaves) {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = GRAIN_SIDE;
  const pen = canvas.getContext("2d");
  const image = pen.createImageData(GRAIN_SIDE, GRAIN_SIDE);
  noiseOf(seed, octaves).forEach((light, at) => {
    const level = clamp(Math.round(MEAN * light), 0, 255);
    image.data.set([level, level, level, 255], 4 * at);
  });
  pen.putImageData(image, 0, 0);
  const texture = new THREE.CanvasTexture(canvas);
  texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
  texture.repeat.set(1 / metres, 1 / metres);
  texture.colorSpace = THREE.SRGBColorSpace;
  texture.anisotropy = Math.min(8, renderer.capabilities.getMaxAnisotropy());
  const lighter = 1 / (MEAN / 255) ** 2.2;
  return { map: texture, color: new THREE.Color(lighter, lighter, lighter) };
}

const asphaltGrain = (renderer) => grainOf(renderer, 5, 11, [[128, 0.34], [256, 0.3], [8, 0.1]]);
const meadowGrain = (renderer) => grainOf(renderer, 23, 23, [[96, 0.22], [192, 0.26], [256, 0.2], [16, 0.08]]);
