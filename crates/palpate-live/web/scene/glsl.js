// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * The text of the programs that draw: a marcher through space and a map of a plane, around the
 * formula of a scene or around samples of it.
 *
 * The formula is called in one place of the text, in a loop whose bound the compiler does not
 * know: compilers write every call out, and a scene's formula may have thousands of operations.
 */

/** The maps of a plane, by the number that the programs know. */
export const MAPS = { inside: 0, distance: 1, gradient: 2, promise: 3, difference: 4 };

export const VERTEX = `#version 300 es
void main() {
  gl_Position = vec4(vec2(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? 3 : -1), 0, 1);
}`;

const HEAD = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp sampler3D;
uniform int zero;
out vec4 result;
`;

/** A point in as many dimensions as the field has. */
const argument = (/** @type {number} */ dimension) => (dimension === 2 ? '.xy' : '');

/** Samples of the whole scene and of two bodies, as a formula. Beyond the grid a value is that of
 * the nearest place in it and the way there. */
export const samples = (/** @type {number} */ dimension) => `
uniform sampler${dimension}D grid0, grid1, grid2;
uniform vec3 gridLow[3], gridHigh[3];
uniform int firstBody;
float sampled(sampler${dimension}D grid, vec3 p, vec3 low, vec3 high) {
  vec3 inside = clamp(p, low, high);
  vec3 part = (inside - low) / max(high - low, vec3(1e-30));
  vec${dimension} count = vec${dimension}(textureSize(grid, 0));
  vec${dimension} at = (part${argument(dimension)} * (count - 1.0) + 0.5) / count;
  return textureLod(grid, at, 0.0).x + distance(p, inside);
}
vec2 field(vec${dimension} place, int only) {
  vec3 p = vec3(place${dimension === 2 ? ', 0' : ''});
  float value = only < 0 ? sampled(grid0, p, gridLow[0], gridHigh[0])
    : only == firstBody ? sampled(grid1, p, gridLow[1], gridHigh[1])
    : sampled(grid2, p, gridLow[2], gridHigh[2]);
  return vec2(value, float(only));
}`;

/** Values of a place in the plane, as a colour. */
const MAP = `
uniform sampler2D palette;
uniform int map;
uniform float spacing, range, sineFactor;
uniform bool isolines, asInMemoir, positiveInside;
uniform vec3 channels;
const vec3 INK = vec3(0.09, 0.10, 0.12);

vec3 fromOklab(vec3 c) {
  vec3 lms = vec3(c.x + 0.3963377774 * c.y + 0.2158037573 * c.z,
    c.x - 0.1055613458 * c.y - 0.0638541728 * c.z, c.x - 0.0894841775 * c.y - 1.291485548 * c.z);
  lms = lms * lms * lms;
  vec3 linear = clamp(vec3(4.0767416621 * lms.x - 3.3077115913 * lms.y + 0.2309699292 * lms.z,
    -1.2684380046 * lms.x + 2.6097574011 * lms.y - 0.3413193965 * lms.z,
    -0.0041960863 * lms.x - 0.7034186147 * lms.y + 1.707614701 * lms.z), 0.0, 1.0);
  return mix(1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055, 12.92 * linear,
    vec3(lessThanEqual(linear, vec3(0.0031308))));
}

// The wheel of directions of palpate-plot: lightness to the right, yellow up.
vec3 direction(vec2 g) {
  float beyond = max(length(g), 1.0);
  g /= beyond;
  vec3 c = vec3(0.69, 0, 0) + g.x * vec3(0.12, -0.0579555, 0) + g.y * vec3(0, 0.0155291, 0.12);
  return fromOklab(c / beyond);
}

vec4 body(int number) {
  return texelFetch(palette, ivec2(max(number, 0) % textureSize(palette, 0).x, 0), 0);
}

// How much a line covers of a pixel at this many pixels from its middle.
float line(float pixels, float width) {
  return clamp(0.5 * width + 0.5 - pixels, 0.0, 1.0);
}

// 'pixel' is the change of the value over a pixel, 'slope' the length of the gradient, 'g' its
// part in the plane.
vec3 mapped(float value, float other, vec2 g, float slope, float pixel, int number) {
  vec3 tint = body(number).rgb;
  float inner = step(value, 0.0);
  float zeroLine = line(abs(value) / pixel, 2.0);
  if (map == 4) {
    float change = (value - other) / range;
    vec3 c = mix(vec3(0.97), change < 0.0 ? vec3(0.13, 0.40, 0.67) : vec3(0.70, 0.09, 0.17),
      1.0 - exp(-4.0 * abs(change)));
    return mix(c, INK, 0.8 * zeroLine);
  }
  vec3 colour;
  if (map == 0) {
    colour = mix(vec3(0.965, 0.965, 0.955), mix(tint, vec3(1), 0.25), inner);
  } else if (map == 1 && asInMemoir) {
    colour = mix(vec3(0.9, 0.6, 0.3), vec3(0.35, 0.6, 0.9), inner);
    colour *= 0.75 + 0.25 * cos(60.0 * sineFactor * value / range);
    return mix(colour, vec3(1), zeroLine);
  } else if (map == 1) {
    float far = 1.0 - exp(-1.6 * abs(value) / range);
    colour = value < 0.0 ? mix(vec3(0.706, 0.827, 0.925), vec3(0.29, 0.52, 0.75), far)
      : mix(vec3(0.976, 0.80, 0.58), vec3(1.0, 0.976, 0.94), far);
    colour *= mod(floor(value / spacing), 2.0) < 0.5 ? 1.0 : 0.965;
  } else if (map == 2) {
    g = positiveInside ? -g : g;
    colour = asInMemoir
      ? channels * vec3(0.5 + 0.5 * g, 0.5 + 0.5 * cos(60.0 * sineFactor * value / range))
      : direction(g);
  } else {
    // Outside and inside have promises of their own: exact, bound or Lipschitz.
    int codes = int(body(number).a * 255.0 + 0.5);
    int promise = value < 0.0 ? codes / 4 : codes % 4;
    colour = promise == 0 ? vec3(0.72, 0.88, 0.76) : promise == 1 ? vec3(0.74, 0.83, 0.95)
      : vec3(0.97, 0.86, 0.66);
    colour = mix(colour, vec3(0.30, 0.30, 0.62), clamp(1.0 - slope, 0.0, 1.0));
    colour = mix(colour, vec3(0.78, 0.16, 0.10), clamp(2.0 * (slope - 1.02), 0.0, 1.0));
  }
  if (isolines && spacing > 0.0) {
    float nearest = round(value / spacing);
    float covered = line(abs(value - nearest * spacing) / pixel, 1.0);
    float fade = clamp(spacing / pixel / 5.0 - 0.4, 0.0, 1.0);
    float strong = mod(abs(nearest), 5.0) < 0.5 ? 0.6 : 0.34;
    vec3 ink = value < 0.0 ? vec3(0.05, 0.17, 0.30) : vec3(0.37, 0.21, 0.02);
    colour = mix(colour, map == 2 ? vec3(0.1) : ink, nearest == 0.0 ? 0.0 : covered * fade * strong);
  }
  bool white = map == 1;
  colour = mix(colour, INK, white ? 0.7 * line(abs(value) / pixel, 4.5) : 0.0);
  return mix(colour, white ? vec3(1) : INK, zeroLine);
}

vec3 corner(int k) {
  return vec3((k & 2) == 0 ? 1 : -1, (k & 1) == 0 ? 1 : -1, k == 0 || k == 3 ? 1 : -1);
}
`;

/** A map of a plane. @param {string} field @param {number} dimension */
export const flat = (field, dimension) => `${HEAD}${field}${MAP}
uniform vec2 viewport, lowerLeft, centre, span;
uniform vec3 origin, across, above, shift, otherShift;
uniform int first, last, only, other;
uniform float leastStep;
void main() {
  vec2 at = (gl_FragCoord.xy - lowerLeft) / viewport - 0.5;
  vec2 place = centre + at * span;
  vec3 p = origin + place.x * across + place.y * above;
  float pixel = span.y / viewport.y;
  float h = max(0.5 * pixel, leastStep);
  vec3 sum = vec3(0);
  vec2 here = vec2(0);
  float value = 0.0;
  for (int k = first + zero; k < last; k++) {
    vec3 q = p + (k == 5 ? otherShift : shift) + (k < 4 ? h * corner(k) : vec3(0));
    vec2 f = field(q${argument(dimension)}, k == 5 ? other : only);
    if (k < 4) sum += f.x * corner(k);
    else if (k == 4) here = f;
    else value = f.x;
  }
  vec3 gradient = sum${dimension === 2 ? ' * vec3(1, 1, 0)' : ''} / (4.0 * h);
  vec2 g = vec2(dot(gradient, across), dot(gradient, above));
  // Without a gradient, the neighbouring pixels tell how fast the value changes.
  float change = max(first == 0 ? pixel * length(g) : length(vec2(dFdx(here.x), dFdy(here.x))),
    0.2 * pixel);
  result = vec4(mapped(here.x, value, g, length(gradient), change, int(here.y)), 1);
}`;

/** A march through space, with a plane in it if \`sliced\`. With \`picking\`, the place that a
 * pixel shows, and the number of its body; -2 where it shows nothing.
 * @param {string} field */
export const space = (field) => `${HEAD}${field}${MAP}
uniform vec2 viewport, lowerLeft;
uniform vec3 eye, forward, across, above, low, high, shift, otherShift;
uniform float cone, rate, leastStep;
uniform int steps, only, other;
uniform bool picking, sliced;
uniform vec3 sliceOrigin, sliceAcross, sliceAbove;
uniform float sliceReach;
const int MARCH = 0, SURFACE = 1, SLICE = 2;

void main() {
  vec2 at = (gl_FragCoord.xy - lowerLeft) / viewport * 2.0 - 1.0;
  vec3 ray = normalize(forward + at.x * across + at.y * above);
  vec3 one = (low - eye) / ray, two = (high - eye) / ray;
  vec3 nearer = min(one, two), farther = max(one, two);
  float t = max(max(nearer.x, nearer.y), max(nearer.z, 0.0));
  float end = min(farther.x, min(farther.y, farther.z));
  int phase = MARCH, k = 0, last = 4;
  vec3 p, normal = cross(sliceAcross, sliceAbove);
  float facing = 1.0, h = leastStep;
  if (sliced) {
    // What is between the viewer and the plane is cut away.
    facing = dot(ray, normal);
    float cut = dot(sliceOrigin - eye, normal) / facing;
    p = eye + cut * ray;
    vec2 place = vec2(dot(p - sliceOrigin, sliceAcross), dot(p - sliceOrigin, sliceAbove));
    t = max(t, cut);
    if (!(cut > 0.0)) end = -1.0;
    else if (max(abs(place.x), abs(place.y)) < sliceReach && !picking) {
      phase = SLICE;
      h = max(cone * cut, leastStep);
      last = map == 4 ? 6 : 5;
    }
  }
  if (phase == MARCH && t > end) {
    result = vec4(0, 0, 0, picking ? -2 : 0);
    return;
  }
  vec3 sum = vec3(0);
  vec2 here = vec2(0);
  vec4 front = vec4(0), back = vec4(0);
  float open = 1.0;
  for (int i = zero; i < steps; i++) {
    bool isOther = phase == SLICE && k == 5;
    vec3 q = phase == MARCH ? eye + t * ray
      : phase == SURFACE && k == 4 ? p + 24.0 * h * normalize(sum)
      : p + (k < 4 ? h * corner(k) : vec3(0));
    vec2 f = field(q + (isOther ? otherShift : shift), isOther ? other : only);
    if (phase == MARCH) {
      if (f.x < cone * t) {
        p = q;
        here = f;
        phase = SURFACE;
        // The step reaches over pixels, so that edges are not frayed, and the shadow in corners
        // is as wide on the screen everywhere.
        h = max(cone * t, leastStep);
        k = 0;
        last = 5;
        sum = vec3(0);
        if (picking) break;
      } else {
        t += f.x * rate;
        if (t > end) break;
      }
      continue;
    }
    if (k < 4) sum += f.x * corner(k);
    if (phase == SURFACE && k == 4) open = clamp(f.x / (24.0 * h), 0.0, 1.0);
    if (phase == SLICE && k == 4) here = f;
    k++;
    if (k < last) continue;
    if (phase == SURFACE) {
      vec3 n = normalize(sum);
      float key = max(dot(n, normalize(0.5 * above / length(above) + 0.35 * across / length(across)
        - forward)), 0.0);
      float sky = 0.5 + 0.5 * n.y;
      float rim = pow(1.0 - max(dot(n, -ray), 0.0), 3.0);
      vec3 tint = body(int(here.y)).rgb;
      vec3 lit = tint * (0.30 + 0.16 * sky + 0.58 * key) * mix(0.62, 1.0, open);
      lit += 0.10 * pow(key, 24.0) + 0.10 * rim * sky;
      back = vec4(lit, 1);
      break;
    }
    vec3 gradient = sum / (4.0 * h);
    vec2 g = vec2(dot(gradient, sliceAcross), dot(gradient, sliceAbove));
    // Half a pixel, seen askew.
    float pixel = 2.0 * cone * dot(p - eye, ray) / mix(abs(facing), 1.0, 0.4);
    vec3 colour = mapped(here.x, f.x, g, length(gradient), max(length(g), 0.2) * pixel,
      int(here.y));
    bool inner = here.x < 0.0;
    front = vec4(colour, inner ? 1.0 : 0.72);
    if (inner || t > end) break;
    phase = MARCH;
  }
  if (picking) {
    result = phase == SURFACE ? vec4(p, here.y) : vec4(0, 0, 0, -2);
    return;
  }
  result = vec4(front.rgb * front.a + back.rgb * (1.0 - front.a),
    front.a + back.a * (1.0 - front.a));
}`;
