# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
# ---
# jupyter:
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # The memoir: collision detection with signed distance functions
#
# Fields in the plane, their gradients, a circle, a triangle and another field against a field: the questions of a
# memoir on collision detection with SDFs (after Macklin 2020 and Liu 2024), each with a proof.

# %%
import matplotlib.pyplot as plt
import numpy as np
import palpate as pp

# %% [markdown]
# ## A field and its gradient
#
# A star and a box, blended. Isolines are lines of equal distance; the gradient points away from the surface.

# %%
star = pp.regular_star(branches=5, outer_radius=0.5, inner_radius=0.22)
field = star.smooth_union(pp.cuboid([0.9, 0.2]).translated([0.5, -0.3]), width=0.02)
field

# %%
x, y = np.meshgrid(np.linspace(-0.8, 1.2, 15), np.linspace(-0.8, 0.8, 12))
points = np.stack([x, y], axis=-1)
gradient = field.gradient(points)
fig, ax = plt.subplots(figsize=(7, 5))
field.plot(ax=ax)
ax.quiver(x, y, gradient[..., 0], gradient[..., 1], color="#8a94a6", width=0.003)

# %% [markdown]
# ## Field and circle
#
# The memoir tests f(C) < r. That is right where the field is a distance; where it is a bound, the search says what is.

# %%
centre, radius = [0.7, 0.1], 0.25
value = field.at(centre)
circle = pp.ball(radius, dimension=2).translated(centre)
met = pp.overlap(field, circle)
print(f"f(C) = {value.distance:.4f} m ({value.quality}), r = {radius} m: f(C) < r is {value.distance < radius}")
print(f"proven: they overlap: {met.overlaps}, after {met.evaluations} evaluations")

# %% [markdown]
# ## Field and triangle
#
# The least value of the field on the sides of a triangle, by searches with bounds instead of a descent from a start.

# %%
corners = np.array([[0.3, 0.1], [0.9, 0.15], [0.7, 0.7]])
triangle = pp.Mesh(corners, [[0, 1], [1, 2], [2, 0]])
touch = pp.mesh_contacts(field, triangle)
print(f"sides that touch: {touch.hits.tolist()}; contacts: {touch.contacts.point_b.round(4).tolist()}")

# %%
fig, ax = plt.subplots(figsize=(7, 5))
field.plot(ax=ax)
ax.plot(*np.vstack([corners, corners[:1]]).T, color="#2a9d8f")
ax.plot(*touch.contacts.point_b.T, "o", color="#d1495b")

# %% [markdown]
# ## Field and field
#
# Two fields, one turned: how deep are they in each other, and which contacts span the region?

# %%
other = star.rotated(degrees=20).translated([0.75, 0.25])
apart = pp.separation(field, other)
contacts = pp.manifold(field, other)
print(f"separation between {apart.lower:.5f} and {apart.upper:.5f} m; {len(contacts)} contacts")

# %%
fig, ax = plt.subplots(figsize=(7, 5))
(field | other).plot(ax=ax)
pp.plot_contacts(contacts, ax=ax)
