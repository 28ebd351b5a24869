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
# # Contacts of a nut and a bolt
#
# M6, five times as large, with 0.1 mm to spare: a metric thread with crests of an eighth of the pitch, roots of a quarter
# and flanks at 60 degrees (ISO 68-1). How far apart are nut and bolt, and where do they touch when the nut is let down?

# %%
import matplotlib.pyplot as plt
import numpy as np
import palpate as pp

# %%
PITCH = 0.005
thread = pp.screw_thread(
    radius=0.015, height=0.06, pitch=PITCH, starts=1, profile=[PITCH / 8, PITCH / 4, 0.0027063]
)
bolt = thread & pp.rounded_cylinder(radius=0.015, height=0.06, rounding=0.003)
nut = pp.hexagonal_prism(radius=0.02885, height=0.025) - thread.offset(0.0001)
nut

# %% [markdown]
# ## How far apart
#
# Nut and bolt share one thread, so the nut lies screwed on as it is. The bounds are proven; the true distance is between
# them.

# %%
apart = pp.separation(bolt, nut, tolerance=1e-5)
print(f"between {1e3 * apart.lower:.4f} and {1e3 * apart.upper:.4f} mm, {apart.stop}")

# %%
heights = np.linspace(-0.0003, 0.0003, 25)
let_down = np.stack([0 * heights, heights, 0 * heights], axis=1)
found = pp.separations(bolt, nut, let_down, tolerance=1e-5, threads=0)
fig, ax = plt.subplots(figsize=(7, 4))
ax.fill_between(1e3 * heights, 1e3 * found.lower, 1e3 * found.upper, step=None, alpha=0.4)
ax.plot(1e3 * heights, 1e3 * found.upper)
ax.axhline(0, color="k", linewidth=0.6)
ax.set(xlabel="nut moved up [mm]", ylabel="separation [mm]")

# %% [markdown]
# ## Where they touch
#
# Let down by 0.15 mm, the nut rests on the flanks.

# %%
lower = nut.translated([0, -0.00015, 0])
touch = pp.manifold(bolt, lower, margin=1e-4)
print(f"{len(touch)} contacts, the deepest {1e3 * touch.contacts.gap.min():.3f} mm; whole: {touch.is_whole}")

# %%
fig, ax = plt.subplots(figsize=(5, 6))
(bolt | lower).plot(ax=ax)
pp.plot_contacts(touch, ax=ax)
ax.set_title("Contacts, seen along z")
