# SPDX-License-Identifier: GPL-3.0-or-later
"""Scalar kernels that Numba compiles over arrays. For compiled.py.

They are microfacet lobes, places on a rectangle light, and local frames. The same equations are in `lib`, where each
has its source: one loop for each step of the integrator, no array between its parts. `ggx` is None for Beckmann: Numba
then leaves out the other branch. `pip install numba`; the product does not need it.
"""

import math

import numpy as np
from numba import njit

COMPILED = {"nogil": True, "error_model": "numpy", "cache": True}
FLOOR, HIDDEN = 1e-70, 1e100
SQRT_PI = math.sqrt(math.pi)
EPS, TINY = float(np.finfo(float).eps), float(np.finfo(float).tiny)


@njit(**COMPILED)
def smith_lambda(ggx, x, y, z, ax, ay):
    if z <= 0.0:
        return HIDDEN
    sine2 = (x * ax) ** 2 + (y * ay) ** 2
    z = min(max(z, FLOOR), 1.0)
    if ggx is None:
        a = z / math.sqrt(max(sine2, FLOOR))
        return max(0.5 * (math.exp(-a * a) / (SQRT_PI * a) - math.erfc(a)), 0.0)
    return 0.5 * sine2 / (z * (z + math.sqrt(z * z + sine2)))


@njit(**COMPILED)
def density(ggx, x, y, z, ax, ay):
    if z <= 0.0:
        return 0.0
    tangent2, z2 = (x / ax) ** 2 + (y / ay) ** 2, max(z, FLOOR) ** 2
    if ggx is None:
        return math.exp(-tangent2 / z2) / (z2 * z2 * (math.pi * (ax * ay)))
    return 1.0 / ((tangent2 + z2) ** 2 * (math.pi * (ax * ay)))


@njit(**COMPILED)
def visible_tangent(sine, cosine, u, lambda_o, table, scale, least, largest, views, levels):
    u = min(max(u, least), largest)
    cot = cosine / sine
    s = 1.0 / (1.0 + cot)
    c = cot * s
    logit = math.log(u / (1.0 - u))
    along, across = 0.5 * levels + scale * (logit / math.sqrt(2.0 + abs(logit))), s * views
    column, row = int(along), min(int(across), views - 1)
    along -= column
    across -= row
    k = row * (levels + 1) + column
    low, high = table[k], table[k + levels + 2]
    here = low + (table[k + 1] - low) * along
    x = here + (table[k + levels + 1] + (high - table[k + levels + 1]) * along - here) * across
    low = max(low, 1e-10 - cot)
    x = max(x, low)
    gauss = math.exp(-x * x)
    excess = c * SQRT_PI * math.erfc(x) + s * gauss - 2.0 * SQRT_PI * (1.0 - u) * c * (1.0 + lambda_o)
    weight = c + s * x
    newton, pull = excess / (weight * gauss), s / weight
    curvature = math.sqrt(max(1.0 + newton * (pull - 2.0 * x), 0.0))
    step = newton / (1.0 + curvature)
    cubic = (x * (x - pull) - 0.5) * step * step * (2.0 / 3.0) / max(curvature, 0.5)
    return min(max(x + step * (1.0 - min(max(cubic, -0.01), 0.01)), low), high)


# Wichura 1988, algorithm AS 241: Numba has no inverse of the normal distribution.
NEAR = (
    (3.3871328727963666080e0, 1.3314166789178437745e2, 1.9715909503065514427e3, 1.3731693765509461125e4,
     4.5921953931549871457e4, 6.7265770927008700853e4, 3.3430575583588128105e4, 2.5090809287301226727e3),
    (1.0, 4.2313330701600911252e1, 6.8718700749205790830e2, 5.3941960214247511077e3,
     2.1213794301586595867e4, 3.9307895800092710610e4, 2.8729085735721942674e4, 5.2264952788528545610e3),
)  # fmt: skip
MIDDLE = (
    (1.42343711074968357734e0, 4.63033784615654529590e0, 5.76949722146069140550e0, 3.64784832476320460504e0,
     1.27045825245236838258e0, 2.41780725177450611770e-1, 2.27238449892691845833e-2, 7.74545014278341407640e-4),
    (1.0, 2.05319162663775882187e0, 1.67638483018380384940e0, 6.89767334985100004550e-1,
     1.48103976427480074590e-1, 1.51986665636164571966e-2, 5.47593808499534494600e-4, 1.05075007164441684324e-9),
)  # fmt: skip
FAR = (
    (6.65790464350110377720e0, 5.46378491116411436990e0, 1.78482653991729133580e0, 2.96560571828504891230e-1,
     2.65321895265761230930e-2, 1.24266094738807843860e-3, 2.71155556874348757815e-5, 2.01033439929228813265e-7),
    (1.0, 5.99832206555887937690e-1, 1.36929880922735805310e-1, 1.48753612908506148525e-2,
     7.86869131145613259100e-4, 1.84631831751005468180e-5, 1.42151175831644588870e-7, 2.04426310338993978564e-15),
)  # fmt: skip


@njit(**COMPILED)
def rational(parts, r):
    above = below = 0.0
    for k in range(7, -1, -1):
        above, below = above * r + parts[0][k], below * r + parts[1][k]
    return above / below


@njit(**COMPILED)
def normal_quantile(p):
    q = p - 0.5
    if abs(q) <= 0.425:
        return q * rational(NEAR, 0.180625 - q * q)
    r = math.sqrt(-math.log(min(p, 1.0 - p)))
    return math.copysign(rational(MIDDLE, r - 1.6) if r <= 5.0 else rational(FAR, r - 5.0), q)


@njit(**COMPILED)
def set_up(ggx, wo, ax, ay, lambda_o, above, cos_o, pdf_of_d):
    for i in range(wo.shape[1]):
        lambda_o[i] = smith_lambda(ggx, wo[0, i], wo[1, i], wo[2, i], ax[i], ay[i])
        above[i] = wo[2, i] > 0.0
        cos_o[i] = max(wo[2, i], FLOOR)
        pdf_of_d[i] = 1.0 / ((1.0 + lambda_o[i]) * 4.0 * cos_o[i])


@njit(**COMPILED)
def evaluate(ggx, wi, wo, ax, ay, lambda_o, cos_o, pdf_of_d, value, pdf):
    for i in range(wo.shape[1]):
        value[i] = pdf[i] = 0.0
        if wi[2, i] > 0.0 and wo[2, i] > 0.0:
            x, y, z = wi[0, i] + wo[0, i], wi[1, i] + wo[1, i], max(wi[2, i] + wo[2, i], FLOOR)
            d = density(ggx, x, y, z, ax[i], ay[i]) * (x * x + y * y + z * z) ** 2
            pdf[i] = d * pdf_of_d[i]
            lambda_i = smith_lambda(ggx, wi[0, i], wi[1, i], wi[2, i], ax[i], ay[i])
            value[i] = d / (1.0 + (lambda_i + lambda_o[i])) / cos_o[i] * 0.25


@njit(**COMPILED)
def sample(ggx, wo, ax, ay, lambda_o, pdf_of_d, u1, u2, table, scale, least, largest, views, levels, wi, weight, pdf):
    for i in range(wo.shape[1]):
        a, b, ox, oy, oz = ax[i], ay[i], wo[0, i], wo[1, i], wo[2, i]
        cosine = min(max(oz, FLOOR), 1.0)
        if ggx is None:
            x, y = ox * a + 1e-150, oy * b
            sine = math.sqrt(x * x + y * y)
            t = visible_tangent(sine, cosine, u1[i], lambda_o[i], table, scale, least, largest, views, levels)
            c = math.sqrt(0.5) * normal_quantile(min(max(u2[i], 0.5 - 0.5 * largest), largest))
            tx, ty = a * (x * t - y * c) / sine, b * (y * t + x * c) / sine
            mz = 1.0 / math.sqrt(tx * tx + ty * ty + 1.0)
            mx, my = tx * mz, ty * mz
        else:
            length = cosine * (1.0 + 2.0 * lambda_o[i])
            height = 1.0 + cosine / length
            drop, phi = height * u2[i], 2.0 * math.pi * u1[i]
            sine = math.sqrt(min(max(drop * (2.0 - drop), 0.0), 1.0))
            mx = (ox * a / length + sine * math.cos(phi)) * a
            my = (oy * b / length + sine * math.sin(phi)) * b
            mz = height * (1.0 - min(u2[i], largest))
            scaling = 1.0 / math.sqrt(mx * mx + my * my + mz * mz)
            mx, my, mz = mx * scaling, my * scaling, mz * scaling
        twice = 2.0 * (ox * mx + oy * my + oz * mz)
        x, y, z = twice * mx - ox, twice * my - oy, twice * mz - oz
        wi[0, i], wi[1, i], wi[2, i] = x, y, z
        weight[i] = pdf[i] = 0.0
        if z > 0.0 and oz > 0.0:
            lambda_i = smith_lambda(ggx, x, y, z, a, b)
            weight[i] = (1.0 + lambda_o[i]) / (1.0 + (lambda_i + lambda_o[i]))
            pdf[i] = density(ggx, mx, my, mz, a, b) * pdf_of_d[i]


@njit(**COMPILED)
def edge(x, y0, y1, h2):
    x2, product = x * x, y0 * y1
    square0, square1 = x2 + (y0 * y0 + h2), x2 + (y1 * y1 + h2)
    r0, r1 = math.sqrt(square0), math.sqrt(square1)
    x2 += h2
    d = (square0 + square1 - x * x - h2) * x2 / (r0 * r1 + abs(product)) + (product + abs(product)) + x2 + (r0 + r1) * x
    return r0, r1, d


@njit(**COMPILED)
def half_angle(x, r0, r1, d, far, far0, far1, far_d, determinant):
    middle = far + x
    sine = (middle / (far1 + r1) + 1.0) * (far + far0) + (middle / (far0 + r0) + 1.0) * (x + r1)
    return math.atan2(sine * (far - x) * determinant, d * far_d + determinant * determinant)


@njit(**COMPILED)
def solid_angle(x0, x1, y0, y1, height, half, half_behind, far_d, behind_d):
    for i in range(height.shape[0]):
        low, high, h2 = max(y0[i], -y1[i]), max(y1[i], -y0[i]), height[i] * height[i]
        determinant = (high - low) * height[i]
        near, far = max(x0[i], -x1[i]), max(x1[i], -x0[i])
        far0, far1, far_d[i] = edge(far, low, high, h2)
        inner = max(near, 0.0)
        r0, r1, d = edge(inner, low, high, h2)
        half[i] = half_angle(inner, r0, r1, d, far, far0, far1, far_d[i], determinant)
        half_behind[i] = behind_d[i] = 0.0
        if near < 0.0:
            behind0, behind1, behind_d[i] = edge(-near, low, high, h2)
            half_behind[i] = half_angle(0.0, r0, r1, d, -near, behind0, behind1, behind_d[i], determinant)
            half[i] += half_behind[i]


@njit(**COMPILED)
def place(x0, x1, y0, y1, height, half, half_behind, far_d, behind_d, u1, u2, place_x, place_y):
    for i in range(height.shape[0]):
        low, high, h, rest = max(y0[i], -y1[i]), max(y1[i], -y0[i]), height[i], 1.0 - u2[i]
        n, d, beyond, sign = (high - low) * h, far_d[i], (1.0 - u1[i]) * half[i], 1.0
        if u1[i] * half[i] < half_behind[i]:
            d, beyond, sign = behind_d[i], u1[i] * half[i], -1.0
        part = math.tan(beyond)
        t = (d * part + n) / max(d - n * part, EPS * n)
        m = (h * h + low * high) * t
        bottom = (n - m) * t * (h + high * t) * (h - low * t)
        x = max((1.0 - t * t) * n - 2.0 * m, 0.0) * h / (2.0 * math.sqrt(bottom)) * sign
        x = min(max(x * math.copysign(1.0, x0[i] + x1[i]), x0[i]), x1[i])
        x2 = x * x + h * h
        r0, r1 = math.sqrt(x2 + low * low), math.sqrt(x2 + high * high)
        h0 = low / r0
        over, below, above = abs(h0), x2 / ((abs(low) + r0) * r0), x2 / ((high + r1) * r1)
        less = min((below + over - h0) * rest + above * u2[i], (h0 + over + below) * rest + (2.0 - above) * u2[i])
        y = (high / r1 * u2[i] + h0 * rest) * math.sqrt(x2 / max(less * (2.0 - less), TINY))
        place_x[i] = x
        place_y[i] = min(max(y * math.copysign(1.0, y0[i] + y1[i]), y0[i]), y1[i])


@njit(**COMPILED)
def to_local(v, t, s, n, local):
    for i in range(v.shape[1]):
        for k, axis in enumerate((t, s, n)):
            local[k, i] = axis[0, i] * v[0, i] + axis[1, i] * v[1, i] + axis[2, i] * v[2, i]


@njit(**COMPILED)
def to_world(v, t, s, n, world):
    for i in range(v.shape[1]):
        for k in range(3):
            world[k, i] = t[k, i] * v[0, i] + s[k, i] * v[1, i] + n[k, i] * v[2, i]
