// What the recorded formulas call, in single precision. Choices are mixes, never branches.
float select_less(float a, float b, float c, float d) { return mix(d, c, a < b); }
float squared(float a) { return a * a; }
float norm(float a) { return abs(a); }
float norm(float a, float b) { return sqrt(a * a + b * b); }
float norm(float a, float b, float c) { return sqrt(a * a + b * b + c * c); }
float orthant(float a) { return a; }
float orthant(float a, float b) {
  return norm(max(a, 0.0), max(b, 0.0)) + min(max(a, b), 0.0);
}
float orthant(float a, float b, float c) {
  return norm(max(a, 0.0), max(b, 0.0), max(c, 0.0)) + min(max(max(a, b), c), 0.0);
}
float nearest_multiple(float a, float spacing, float low, float high) {
  return roundEven(clamp(a / spacing, low, high)) * spacing;
}
// The sine of a + quarters * pi/2. Built-in sines may be wrong by 2^-11. Pi/2 in three parts, of
// which the first two have few bits.
float turned(float a, int quarters) {
  float n = roundEven(a * 0.63661977);
  float x = ((a - n * 1.5703125) - n * 4.8375129699707031e-4) - n * 7.5497899548918821e-8;
  float y = x * x;
  float s = x + x * y * (((y * 2.7557319e-6 - 1.9841270e-4) * y + 8.3333333e-3) * y - 0.16666667);
  float c = 1.0 + y * ((((y * -2.7557319e-7 + 2.4801587e-5) * y - 1.3888889e-3) * y + 4.1666667e-2) * y - 0.5);
  int quadrant = int(n) + quarters;
  float v = mix(s, c, (quadrant & 1) != 0);
  return mix(v, -v, (quadrant & 2) != 0);
}
float sine(float a) { return turned(a, 0); }
float cosine(float a) { return turned(a, 1); }
// The angle of (x, y) as a part of a turn: from the eighth of a turn that holds it, less 0, 1/16
// or 1/8, by the series of the arc tangent.
float turn(float x, float y) {
  float across = abs(x), up = abs(y);
  float longer = max(across, up), shorter = min(across, up);
  longer = mix(1.0, longer, longer > 0.0);
  bool first = shorter > 0.19891237 * longer, second = shorter > 0.66817864 * longer;
  float tangent = mix(0.0, mix(0.41421356, 1.0, second), first);
  float base = mix(0.0, mix(0.0625, 0.125, second), first);
  float r = (shorter - longer * tangent) / (longer + shorter * tangent), y2 = r * r;
  float arc = r * (((((y2 * -0.090909091 + 0.11111111) * y2 - 0.14285714) * y2 + 0.2) * y2 - 0.33333333) * y2 + 1.0);
  float eighth = base + arc * 0.15915494;
  float quarter = mix(eighth, 0.25 - eighth, across < up);
  float half_turn = mix(quarter, 0.5 - quarter, x < 0.0);
  return mix(half_turn, -half_turn, y < 0.0);
}
// The smooth minima: the minimum less what fills the crease, as a part of the unit.
float rest(float a, float b, float unit) { return max(1.0 - abs(a - b) / unit, 0.0); }
float smooth_min_quadratic(float a, float b, float unit) {
  return min(a, b) - squared(rest(a, b, unit)) * (0.25 * unit);
}
float smooth_min_cubic(float a, float b, float unit) {
  float x = rest(a, b, unit);
  return min(a, b) - x * x * x * (unit / 6.0);
}
float smooth_min_quartic(float a, float b, float unit) {
  float x = rest(a, b, unit);
  return min(a, b) - x * x * x * (4.0 - x) * (unit / 16.0);
}
float smooth_min_circular(float a, float b, float unit) {
  float x = rest(a, b, unit);
  return min(a, b) - x * x / (1.0 + x + sqrt(1.0 + x * (2.0 - x))) * unit;
}
float smooth_min_root(float a, float b, float unit) {
  float t = abs(a - b) / unit;
  return min(a, b) - 0.5 / (norm(t, 1.0) + t) * unit;
}
float smooth_min_exponential(float a, float b, float unit) {
  return min(a, b) - log2(1.0 + exp2(-abs(a - b) / unit)) * unit;
}
