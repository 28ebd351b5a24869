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
# # Touch in five minutes
#
# A part is made of closed formulas, asked where it touches a mesh, and felt through a simulated stylus. Lengths are in
# metres, `y` is up, distances are negative inside.

# %%
import matplotlib.pyplot as plt
import numpy as np
import palpate as pp

# %% [markdown]
# ## A part
#
# A plate with a hole and a rounded rim. The last line of a cell shows the shape: isolines on the plane z = 0.

# %%
hole = pp.cylinder(radius=0.02, height=0.1).translated([-0.03, 0, 0])
plate = pp.cuboid([0.12, 0.02, 0.08]).offset(0.002) - hole
knob = pp.ball(0.012).translated([0.04, 0.014, 0])
part = plate.smooth_union(knob, width=0.001)
part

# %%
print(part.promise)
print(part.distance([0, 0.03, 0]), part.distance(np.zeros((2, 3))))

# %% [markdown]
# ## Where it touches a mesh
#
# A mesh comes from a file (`pp.Mesh.load`), from trimesh (`pp.Mesh(theirs)`), or as here from a shape.

# %%
peg = pp.cylinder(radius=0.0195, height=0.06).rotated([0, 0, 1], degrees=4)
peg = peg.translated([-0.03, 0, 0]).mesh(cell=0.002)
touch = pp.mesh_contacts(part, peg)
print(f"{len(touch)} contacts on {len(touch.hits)} faces, the deepest {touch.contacts.gap.min():.6f} m")

# %%
fig, ax = plt.subplots(figsize=(7, 4))
part.plot(ax=ax)
ax.plot(touch.contacts.point_a[:, 0], touch.contacts.point_a[:, 1], ".", color="#d1495b")
ax.set_title("The part and where the peg touches it")

# %% [markdown]
# ## How it feels
#
# A hand slides over the part. On a virtual clock the same run gives the same forces every time; `pp.Servo` does the same
# in real time, with a device.

# %%
hand = [[0, 0.0, 0.03, 0], [0.5, 0.0, 0.011, 0], [1.5, 0.04, 0.024, 0], [2.5, 0.058, 0.011, 0], [3, 0.058, 0.03, 0]]
felt = pp.feel(pp.Scene({"part": part}), hand=hand, duration=3.0)
print(f"{felt.report['ticks']} ticks, largest force {felt.report['largest_force']:.3f} N")

# %%
fig, (above, below) = plt.subplots(2, sharex=True, figsize=(7, 5))
above.plot(felt.trace.time, 1e3 * felt.trace.device[:, 1], label="hand")
above.plot(felt.trace.time, 1e3 * felt.trace.proxy[:, 1], label="proxy")
above.set_ylabel("height [mm]")
above.legend()
below.plot(felt.trace.time, felt.trace.force)
below.set(xlabel="time [s]", ylabel="force [N]")
below.legend(["x", "y", "z"])
