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

import { MAP_COLORS, MAP_NUMBERS, OKLAB, THEMED, WHEEL } from './colors.js';

/** The maps of a plane, by the number that the programs know. */
export const MAPS = { inside: 0, distance: 1, gradient: 2, promise: 3, difference: 4 };

/** The number of the body in a pixel that shows nothing; −1 is a body that is not known. */
export const NOTHING = -2;

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

/** @param {number[]} parts */
const vec3 = (parts) => `vec3(${parts.join(', ')})`;

/** A matrix of rows; the programs take columns. @param {number[][]} rows */
const mat3 = (rows) => `mat3(${[0, 1, 2].flatMap((column) => rows.map((row) => row[column])).join(', ')})`;

/** @param {number} number */
const float = (number) => (Number.isInteger(number) ? `${number}.0` : `${number}`);

/** A colour of the theme: another theme needs no other program. @param {typeof THEMED[number]} name */
function themeColor(name) {
  const number = THEMED.indexOf(name);
  if (number < 0) throw new Error(`themes have no colour ${name}`);
  return `theme[${number}]`;
}

/** A point in as many dimensions as the field has. */
const argument = (/** @type {number} */ dimension) => (dimension === 2 ? '.xy' : '');

/** Samples of the whole scene and of two bodies, as a formula. Beyond the grid a value is that of
 * the nearest place in it and the way there.
 * @param {number} dimension @param {boolean} isTelling whether other samples tell which body a place
 *   belongs to */
export const samples = (dimension, isTelling) => `
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
}${isTelling ? ownerOf(dimension) : ''}`;

/** The nearest body, where the samples of the scene do not tell it. Each place of a grid has its nearest body,
 * and by how much that is nearer than the next: between two bodies, the sum of these is the difference of
 * their distances, and its zero their border.
 * @param {number} dimension */
const ownerOf = (dimension) => `
uniform sampler${dimension}D owners;
uniform vec3 ownersLow, ownersHigh;
float owner(vec3 p, float number) {
  if (number >= 0.0) return number;
  vec3 part = (clamp(p, ownersLow, ownersHigh) - ownersLow) / max(ownersHigh - ownersLow, vec3(1e-30));
  ivec${dimension} last = textureSize(owners, 0) - 1;
  vec${dimension} at = part${argument(dimension)} * vec${dimension}(last);
  ivec${dimension} low = ivec${dimension}(at);
  const int corners = ${2 ** dimension};
  vec2 found[corners];
  for (int i = 0; i < corners; i++) {
    ivec${dimension} way = ivec3(i, i >> 1, i >> 2)${argument(dimension)} & 1;
    found[i] = texelFetch(owners, min(low + way, last), 0).xy;
    for (int axis = 0; axis < ${dimension}; axis++) {
      float beyond = at[axis] - float(low[axis]);
      found[i].y *= way[axis] == 1 ? beyond : 1.0 - beyond;
    }
  }
  float most = -1.0;
  for (int i = 0; i < corners; i++) {
    float sum = 0.0;
    for (int j = 0; j < corners; j++) sum += found[j].x == found[i].x ? found[j].y : 0.0;
    number = sum > most ? found[i].x : number;
    most = max(most, sum);
  }
  return number;
}`;

/** A formula knows the body of a place. @param {string} field */
const owned = (field) => (field.includes('float owner(') ? field
  : `${field}\nfloat owner(vec3 p, float number) { return number; }`);

/** The colours of bodies, and the corners of a tetrahedron: the sum of the values at them, times
 * them, is four times the gradient. */
const COMMON = `
uniform sampler2D palette;
// The number of the selected body and one; 0 without one.
uniform int selected;
const vec3 CHOSEN = ${vec3(MAP_COLORS.chosen)};

bool isSelected(int number) {
  return selected > 0 && number + 1 == selected;
}

vec4 body(int number) {
  return texelFetch(palette, ivec2(max(number, 0) % textureSize(palette, 0).x, 0), 0);
}

vec3 corner(int k) {
  return vec3((k & 2) == 0 ? 1 : -1, (k & 1) == 0 ? 1 : -1, k == 0 || k == 3 ? 1 : -1);
}
`;

/** Values of a place in the plane, as a colour. Emulated graphics cards do all branches, so each
 * map has its own program. */
const MAP = `
uniform float spacing, range, sineFactor;
uniform bool isolines, asInMemoir, positiveInside;
uniform vec3 channels, theme[${THEMED.length}];

vec3 fromOklab(vec3 c) {
  vec3 roots = ${mat3(OKLAB.roots)} * c;
  vec3 linear = clamp(${mat3(OKLAB.linear)} * (roots * roots * roots), 0.0, 1.0);
  return mix(1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055, 12.92 * linear,
    vec3(lessThanEqual(linear, vec3(0.0031308))));
}

vec3 direction(vec2 g) {
  float beyond = max(length(g), 1.0);
  g /= beyond;
  return fromOklab((${themeColor('wheel')} + g.x * ${vec3(WHEEL.right)} + g.y * ${vec3(WHEEL.up)}) / beyond);
}

// How much a line covers of a pixel at this many pixels from its middle.
float line(float pixels, float width) {
  return clamp(0.5 * width + 0.5 - pixels, 0.0, 1.0);
}

// 'pixel' is the change of the value over a pixel, 'slope' the length of the gradient, 'g' its
// part in the plane. Without a card, pictures.js does the same.
vec3 mapped(float value, float other, vec2 g, float slope, float pixel, int number) {
  vec3 tint = body(number).rgb;
  float inner = step(value, 0.0);
  bool isChosen = isSelected(number);
  float zeroLine = line(abs(value) / pixel, isChosen ? 3.0 : 2.0);
  if (map == 4) {
    float change = (value - other) / range;
    vec3 c = mix(${themeColor('equal')}, change < 0.0 ? ${themeColor('less')} : ${themeColor('more')},
      1.0 - exp(-${float(MAP_NUMBERS.contrast)} * abs(change)));
    return mix(c, ${themeColor('ink')}, 0.8 * zeroLine);
  }
  float wave = cos(${float(MAP_NUMBERS.waves)} * sineFactor * value / range);
  vec3 colour;
  if (map == 0) {
    colour = mix(${themeColor('outside')}, mix(tint, ${themeColor('pale')}, ${MAP_NUMBERS.pale}), inner);
  } else if (map == 1 && asInMemoir) {
    colour = mix(${vec3(MAP_COLORS.memoirOutside)}, ${vec3(MAP_COLORS.memoirInside)}, inner);
    colour *= 1.0 - ${MAP_NUMBERS.wave} * (1.0 - wave);
    return mix(colour, ${vec3(MAP_COLORS.surface)}, zeroLine);
  } else if (map == 1) {
    float far = 1.0 - exp(-${MAP_NUMBERS.fade} * abs(value) / range);
    colour = value < 0.0 ? mix(${themeColor('insideNear')}, ${themeColor('insideFar')}, far)
      : mix(${themeColor('outsideNear')}, ${themeColor('outsideFar')}, far);
    colour *= mod(floor(value / spacing), 2.0) < 0.5 ? 1.0 : ${MAP_NUMBERS.band};
  } else if (map == 2) {
    g = positiveInside ? -g : g;
    colour = asInMemoir ? channels * vec3(0.5 + 0.5 * g, 0.5 + 0.5 * wave) : direction(g);
  } else {
    // Outside and inside have promises of their own: exact, bound or Lipschitz.
    int codes = int(body(number).a * 255.0 + 0.5);
    int promise = value < 0.0 ? codes / 4 : codes % 4;
    colour = promise == 0 ? ${themeColor('exact')} : promise == 1 ? ${themeColor('bound')} : ${themeColor('lipschitz')};
    colour = mix(colour, ${themeColor('flat')}, clamp(1.0 - slope, 0.0, 1.0));
    colour = mix(colour, ${themeColor('steep')}, clamp(2.0 * (slope - ${MAP_NUMBERS.steepest}), 0.0, 1.0));
  }
  if (isolines && spacing > 0.0) {
    float nearest = round(value / spacing);
    float covered = line(abs(value - nearest * spacing) / pixel, 1.0);
    float fade = clamp(spacing / pixel / 5.0 - 0.4, 0.0, 1.0);
    float strong = mod(abs(nearest), 5.0) < 0.5 ? 0.6 : 0.34;
    vec3 ink = map == 2 ? ${themeColor('gradientLine')}
      : value < 0.0 ? ${themeColor('insideLine')} : ${themeColor('outsideLine')};
    colour = mix(colour, ink, nearest == 0.0 ? 0.0 : covered * fade * strong);
  }
  bool white = map == 1;
  colour = mix(colour, ${vec3(MAP_COLORS.rim)}, white ? 0.7 * line(abs(value) / pixel, 4.5) : 0.0);
  return mix(colour, isChosen ? CHOSEN : white ? ${vec3(MAP_COLORS.surface)} : ${themeColor('ink')}, zeroLine);
}
`;

/** A map of a plane. @param {string} field @param {number} dimension @param {number} map */
export const flat = (field, dimension, map) => `${HEAD}${owned(field)}${COMMON}const int map = ${map};${MAP}
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
  result = vec4(mapped(here.x, value, g, length(gradient), change,
    int(owner(p + shift, here.y))), 1);
}`;

/** The plane of a slice: what is between it and the viewer is cut away. */
const CUT = `
  vec3 normal = cross(sliceAcross, sliceAbove);
  float facing = dot(ray, normal);
  float cut = dot(sliceOrigin - eye, normal) / facing;
  vec3 place = eye + cut * ray;
  vec3 from = place - sliceOrigin;
  t = max(t, cut);
  if (!(cut > 0.0)) end = -1.0;
  bool isCut = cut > 0.0 && !picking
    && max(abs(dot(from, sliceAcross)), abs(dot(from, sliceAbove))) < sliceReach;
  if (isCut) {
    k = 8;
    h = max(cone * cut, leastStep);
  }
  float planeStep = h;`;

/** A value about the plane. Where the plane is in a body, nothing is seen behind it. */
const TAKE = ` else {
      planeSum += isCorner ? f.x * e : vec3(0);
      planeValue = k == 12 ? f : planeValue;
      otherValue = k == 13 ? f.x : otherValue;
      k++;
      if (k > (map == 4 ? 13 : 12)) {
        if (planeValue.x < 0.0 || t > end) break;
        k = -1;
        base = eye + t * ray;
      }
    }`;

/** The map of the plane, over what is behind it. */
const COVER = `
  vec3 gradient = planeSum / (4.0 * planeStep);
  vec2 g = vec2(dot(gradient, sliceAcross), dot(gradient, sliceAbove));
  // The size of a pixel, seen askew.
  float pixel = 2.0 * cone * cut / mix(abs(facing), 1.0, 0.4);
  vec3 colour = mapped(planeValue.x, otherValue, g, length(gradient),
    max(length(g), 0.2) * pixel, int(owner(place + shift, planeValue.y)));
  float covers = isCut ? (planeValue.x < 0.0 ? 1.0 : 0.72) : 0.0;
  result = vec4(mix(result.rgb, colour, covers), covers + result.a * (1.0 - covers));`;

const SLICE = `
uniform vec3 sliceOrigin, sliceAcross, sliceAbove;
uniform float sliceReach;`;

/** A march through space. With `picking`, the place that a pixel shows, and the number of its
 * body; `NOTHING` where it shows nothing. The loop holds little but the field: emulated graphics cards
 * do all that stands in a loop each time round, so colours come after it.
 * @param {string} field @param {boolean} isSliced whether a plane cuts the scene
 * @param {number} map of the plane */
export const space = (field, isSliced, map) => `${HEAD}${owned(field)}${COMMON}${isSliced ? `const int map = ${map};${MAP}${SLICE}` : ''}
uniform vec2 viewport, lowerLeft;
uniform vec3 eye, forward, across, above, low, high, shift, otherShift;
uniform float cone, rate, leastStep;
uniform int steps, only, other;
uniform bool picking;
// How far from the surface the field tells how open a place is, in steps of differences.
const float SHADE = 24.0;

void main() {
  vec2 at = (gl_FragCoord.xy - lowerLeft) / viewport * 2.0 - 1.0;
  vec3 ray = normalize(forward + at.x * across + at.y * above);
  vec3 one = (low - eye) / ray, two = (high - eye) / ray;
  vec3 nearer = min(one, two), farther = max(one, two);
  float t = max(max(nearer.x, nearer.y), max(nearer.z, 0.0));
  float end = min(farther.x, min(farther.y, farther.z));
  // What comes next: −1 a step of the march; 0 to 3 a corner about the surface, 4 a place before
  // it; 8 to 11 a corner about the plane, 12 the plane, 13 another field there.
  int k = -1;
  float h = leastStep;
  vec3 sum = vec3(0), planeSum = vec3(0);
  vec2 planeValue = vec2(0);
  float number = 0.0, open = 1.0, otherValue = 0.0;${isSliced ? CUT : ''}
  if (k < 0 && t > end) {
    result = vec4(0, 0, 0, picking ? ${NOTHING} : 0);
    return;
  }
  vec3 base = ${isSliced ? 'k < 0 ? eye + t * ray : place' : 'eye + t * ray'};
  for (int i = zero; i < steps; i++) {
    vec3 e = corner(k & 3);
    bool isCorner = k >= 0 && (k & 4) == 0;
    vec3 q = base + (isCorner ? h * e : vec3(0)) + (k == 13 ? otherShift : shift);
    vec2 f = field(q, k == 13 ? other : only);
    if (k < 0) {
      if (f.x < cone * t) {
        number = f.y;
        k = 0;
        // The step reaches over a pixel, so that edges are not frayed, and the shade in corners
        // is as wide on the screen everywhere.
        h = max(cone * t, leastStep);
        if (picking) break;
      } else {
        t += f.x * rate;
        base = eye + t * ray;
        if (t > end) break;
      }
    } else if (k < 4) {
      sum += f.x * e;
      k++;
      if (k == 4) base += SHADE * h * normalize(sum);
    } else if (k == 4) {
      open = clamp(f.x / (SHADE * h), 0.0, 1.0);
      break;
    }${isSliced ? TAKE : ''}
  }
  bool isHit = k >= 0 && k < 8;
  number = owner(eye + t * ray + shift, number);
  if (picking) {
    result = isHit ? vec4(eye + t * ray, number) : vec4(0, 0, 0, ${NOTHING});
    return;
  }
  vec3 n = normalize(sum);
  float key = max(dot(n, normalize(0.5 * normalize(above) + 0.35 * normalize(across) - forward)), 0.0);
  float sky = 0.5 + 0.5 * n.y;
  float rim = 1.0 - max(dot(n, -ray), 0.0);
  vec3 lit = body(int(number)).rgb * (0.30 + 0.16 * sky + 0.58 * key) * mix(0.62, 1.0, open);
  float shine = key * key * key;
  lit += 0.10 * shine * shine * shine + 0.10 * rim * rim * rim * sky;
  // The selected body is tinted, and its edge glows.
  lit = isSelected(int(number)) ? mix(lit, CHOSEN, 0.1 + 0.5 * rim * rim) : lit;
  result = isHit ? vec4(lit, 1) : vec4(0);${isSliced ? COVER : ''}
}`;
