//! What `--help` says after the options.

/// After those of `render`.
pub(crate) const RENDER: &str = "\
A bare model is framed and lit by default: the camera stands in front, to the
right and above, a key, a fill and a little ambient light go with it. Give
--look-from, --fov and the like to move it.

What a pixel shows (--integrator):
  direct      diffuse surfaces in the light of all lights, with shadows
  normal      the normal n as the surface orients it, as the colour (n + 1) / 2
  uv          u as red, v as green, from 0 to 1 over the surface's domain (of a
              cage: over each of its unit squares)
  depth       the distance along the ray, from white to dark grey over the model
  id          a colour for each surface
  iterations  the work of each ray, from black over red and yellow to white
All but direct are black where nothing is hit (iterations: where nothing was
done).

R, G, B and A of an EXR: linear light, a mean over all samples; A is the share of
those that hit something. Of the rest, with direct, the background
(nurbray:background in the header; 0,0,0 there with the others) is part of R, G, B
already: subtract (1 - A) times that before you put the picture over another one.

Samples lie anywhere in their pixel, spread evenly (Sobol points, scrambled); a
pixel is their plain mean: a box filter, one pixel wide.

What an EXR holds besides, the AOVs (--aov chooses):
  Z       distance from the camera (of an orthographic one: from its film) to the
          hit, along the ray, in scene units; infinite where nothing is hit
  P       the point hit, in the scene's coordinates; 0 where nothing is hit
  N       unit normal S_u x S_v there, as the surface is oriented, not turned
          towards the camera; 0 where nothing is hit, or there is no normal
  uv      (u, v) there, in the surface's own knot domain; 0 where nothing is hit
  id      which surface was hit, counted from 0 as `nurbray info` lists them;
          -1 where nothing is hit
  Albedo  the share of light sent back, a mean over all samples; misses count as 0
  doubt   the share of samples of which a ray, to a light perhaps, is doubtful, a
          mean over all samples: where the picture is not certain; if asked for
All except Albedo and doubt describe one hit: that of the pixel's first sample
that hits.
All are 32-bit floats, of some seven digits. At 1e6 from the origin P has steps of
1/16, however small the model; a warning says where they exceed 1/10 of a pixel.
`nurbray cast` writes hits in f64.

The header of an EXR tells how it was made: capDate (UTC), software,
screenWindowWidth, worldToCamera (row vectors, p_camera = p_world M; x to the
right, y up, z forward: left-handed; 32 bits, as P), and as text nurbray:command,
version, seed, spp, samples, integrator, background, camera (all digits of its
numbers), rays (shadow rays among them), hits (of camera rays), doubtful, seconds
(of rendering). If the environment variable SOURCE_DATE_EPOCH is set to a number
of seconds since 1970, capDate is that time and nurbray:seconds is left out: the
same command then writes the same file, byte for byte.

An OUT that cannot be written to is refused before the work begins. If writing one
of several fails later, on a full disk perhaps, the others are written, and the
run fails. A run that is interrupted writes nothing: render ranges of samples one
after the other (--samples) to keep what is done.

With --crop, an EXR keeps the whole picture as its display window and holds the
crop's pixels as its data window; a PNG holds the crop's pixels only.

Samples depend on --seed, the pixel, the sample's number and the dimension only:
crops and sample ranges are the same pixels as the whole picture, on any number
of threads. An EXR holds means over its own samples; its header says how many
(nurbray:spp) and which (nurbray:samples, as A..B). To join the EXRs of several
ranges of one picture, weight R, G, B, A, Albedo and doubt with nurbray:spp and divide
by the sum; the other channels describe the first sample that hits, so take each
pixel's from the lowest range with A > 0 there. (The library's Film::merge does
so without rounding.)

Example:
  nurbray render scenes/teapot.toml -o teapot.exr -o teapot.png --size 1024x768 --spp 64";

/// After those of `bench`.
pub(crate) const BENCH: &str = "\
Ray sets; N is --size:
  primary            the camera's rays through the middles of N x N pixels, in
                     packets: tiles of 64 x 64 pixels, in each a Z-order curve,
                     so that 16 rays are 4 x 4 pixels; if leaves are smaller
                     than two pixels, in batches, as pictures are traced
  single             the same rays in the same order, one call a ray; nurbray's
                     answers are dropped as they come, Embree's stay in its rays
  incoherent         N x N chords of a sphere around the model (1 % wider than
                     it), in batches (which are traced one by one, but with
                     AVX-512 or in scenes of 2^14 leaves and more)
  incoherent-single  the same chords, one call a ray
  ao                 any hit of ambient-occlusion rays: from each exact hit of
                     the primary rays one ray in a random direction around the
                     normal (cosine), 1/5 of the model's diagonal long; in
                     packets if leaves are wider than 1.5 pixels, else in
                     batches
  shadow             any hit on the way from those hits to the scene's first
                     lamp, if they face it; in packets if leaves are wider than
                     two pixels, else in batches
Rays are made before the clock starts, the same for all kernels, for the rival
and in every run; they lie in memory, Embree's in the packets it wants.

Speed: the median of 5 rounds, and (largest - smallest) / median as spread.
Kernels and rival take turns in each round; before the first, each traces all
rays once. All use the same number of threads, which take 4096 rays at a time.

For several models or numbers of threads, a table at the end has a line each.

The diagonal is that of the hierarchy's bounding box, up to some 2e-3 longer than
that of the surfaces' own, which nurbray info gives.

Bytes a Bezier patch: everything that tracing needs, divided by the number of
patches that the surfaces are cut into at their knots (a triangular patch is
three of these; trims and the hierarchy count, too).

--against embree: RTC_GEOMETRY_TYPE_GRID, a grid a knot span, with flag ROBUST;
libembree4 or libembree3, or the library named by EMBREE_LIB. Every knot span is
cut evenly, as often as is needed for the sampled distance between surface and
triangles to stay within tolerance x diagonal, and as often as its neighbours in
the same row or column, so that no gaps open inside a surface. Of trimmed
surfaces, whole cells become grids as large as possible, and cells that trims cut
RTC_GEOMETRY_TYPE_TRIANGLE, a Delaunay triangulation with chords that are equally
near to the trim curves, and points inside where these are many. nurbray
evaluates the vertices, their positions only, on one thread; Embree copies them
and builds its hierarchy.
rtcIntersect1 (rtcOccluded1) for single rays; else the fastest of 1, 8 and 16.
Triangles and rays are moved to the middle of the bounding box and scaled by a
power of two to a size between 1 and 2, which suits Embree's constants best; rays
that begin far away are moved along themselves to beside the triangles first.
tnear is 0. Rays that leave a surface begin twice the tolerance above it, along
its normal, for Embree. (nurbray needs no offset.) A ray differs in t if the
rival's hit is farther from the tangent plane of ours than the tolerance.

With --json one object a line, for each model, ray set, kernel and tolerance:
  model, rays (the set), count, kernel, threads, mrays_per_s, spread, hits,
  doubtful (rays), radius (ao: the rays' length)
  file_seconds    from the file to ready
  build_seconds   from the placed surfaces to ready, part of file_seconds
  total_seconds   from the file to the last ray
  bytes           everything tracing needs
  pieces          Bezier patches: bytes / pieces is the memory a patch
and with a rival:
  rival (embree), rival_version, rival_width (rays a packet), tolerance,
  rival_mrays_per_s, rival_spread, rival_hits, rival_triangles
  rival_plan_seconds
                  to find out how often to cut; part of no other figure
  rival_build_seconds
                  to make the vertices (by nurbray, on one thread), fill the
                  buffers, rtcCommitScene
  rival_commit_seconds
                  the last two of these
  rival_total_seconds
                  as total_seconds, with rival_build_seconds instead of
                  build_seconds
  rival_bytes     what Embree reports, vertices included; normals and (u, v) are
                  not
  rival_tnear (0), rival_offset (of rays that leave a surface)
  hit_disagreements, t_disagreements
                  (rays; the last not of those that ask for any hit)
  ratio           mrays_per_s / rival_mrays_per_s
Preparations are repeated up to 9 times; their figures are those of the run that
took the median time.

Example:
  nurbray bench scenes/teapot.json --against embree --tolerance 1e-3,1e-5
  nurbray bench scenes/octant_sphere.toml scenes/goblet.toml scenes/doo_sabin_body.toml";

/// After those of `audit`.
pub(crate) const AUDIT: &str = "\
Rays are made from the model's own surfaces, by class:
  random       from around the model to points of its bounding box
  aimed        in any direction through any point of a surface
  lengths      as aimed, with directions 1e-8 to 1e8 long
  ranges       as aimed, from before or behind the point, with ranges that begin
               behind the origin or end beyond the point
  borders      through borders: seams, shared edges, free edges
  lines        through knot lines and the lines that halve pieces
  corners      through points where such lines meet
  poles        through edges collapsed to a point (if the model has any)
  seam-planes  in the plane of three points of a border
  axes         parallel to an axis, in faces of bounding boxes too
  chords       through two points of one iso-parameter line: rulings
  trim-edges   through points of the edges that trims cut (if the model has any)
  grazing-k    past a silhouette at 1 - 10^-k and 1 + 10^-k radii of curvature
  tangents     in the tangent plane of a point, through it
  origins      starting on a surface, to within rounding
  leaving      leaving a hit, as secondary rays do
  far          as aimed, from a million sizes away

A third of the rays is traced one by one, a third in packets (except rays that
leave a hit), a third in batches of incoherent rays. Each is asked for its first
hit, and for whether anything is hit.

Columns, for each class:
  rays         rays made
  hits         rays for which the fast path has a hit
  misses       there is a certain hit, but the fast path, without doubt, has no
               first hit, or says that nothing is hit
  wrong        the fast path's hit lies behind a certain hit by more than the
               bound of t (JSON: wrong_roots)
  false        the fast path's hit has a residual above the bound; or lies
               outside the ray's range, or in what trims cut off, by more than
               its error bound; or the exact solver, without doubt, has no root
               there (where two faces end at one trim edge, either may be
               named); or the fast path says that something is hit, and nothing
               is (JSON: false_hits)
  doubtful     rays whose first hit the fast path flags. Flagged answers are not
               judged. (Doubt about whether anything is hit is counted below the
               table; JSON: doubtful_any)
  undecided    rays for which the exact solver could not decide everything; its
               certain hits still count
  error        |S(u, v) - (o + t d)| / M over the hits without doubt: 50 % and
               99 % (at most 1/256 too large), the largest (JSON: error_50,
               error_99, error_max; null without such hits)
  if doubtful  the largest such error of a doubtful hit (JSON: error_doubtful)

Bounds. M is the largest coordinate magnitude of the ray's origin and the
surface's control points. The bound of the residual, for degrees p and q and
e = 2^-53, is b = 8 (p + q + 4) e M + 2 e (|u||S_u| + |v||S_v|): twice the
promise 4 (p + q + 4) e M, for the hit and for checking it, plus the rounding of
u and v. The bound of t, in units of length, is the sum of both hits' b over
|N.d|, at most 4 sqrt(b R) with R the radius of the model. Hits between which
the ray stays within b of the surface count as one.

Certain hits are
  - hits of the exact solver without doubt; but not within the bound of an end
    of the ray's range, nor where the ray passes outside a border by more than a
    quarter of the bound, nor where it passes a trim edge in what is cut off by
    more than the promise and the curve's rounding;
  - the point a ray was aimed at, if trims do not cut it off, and |N.d| >= 0.01
    or the point lies on a border; but not a border point of a triangle or
    subdivision surface that rounding of u and v may have put beyond the border
    by more than a quarter of the promise.
What trims keep is judged by even-odd against polylines within 1/1000 of the
domain of the trim curves, which the tracer does not know. Within twice that
distance of a polyline both sides pass, except for points of class trim-edges:
these are on the curves.

Doubt is counted in three groups: random (classes random and aimed: rays as
pictures have them), nasty (the others), and apart (tangents, origins, and rays
of other classes that are exactly tangent somewhere, as far as f64 can tell, or
run inside a surface). No rounded arithmetic can decide whether a ray in a
tangent plane meets the surface, or whether a ray that starts on it meets it at
its start: doubt is the right answer there. (Rays that say which root they
leave, as secondary rays do, are in class leaving.)

The exit code is 1 if there is a miss, a wrong root or a false hit. With --json
one object: input, rays, seed, kernel, threads, seconds, classes (a list; each
has class, group and the columns), groups (a list: group, rays, doubtful), total
(the columns). RAYS.npy has a row (origin, direction, t_min, t_max) for each ray
at fault, in the order of the classes; rays of class leaving start on the hit
they leave.

Example:
  nurbray audit scenes/teapot.toml --rays 1000000 --offenders offenders.npy";

/// After those of `compare`.
pub(crate) const COMPARE: &str = "\
One ray through the middle of each pixel, the same rays both ways, in the same
run.

--against embree: the surfaces are cut into triangles that stay within each
tolerance (see `nurbray bench --help` for how), and Embree traces those. DIR
gets
  report.md               triangles, build time, memory, rays/s and total time;
                          errors of position and normal; silhouette pixels that
                          differ; rays lost and invented
  plot.svg                speed, memory and errors over the tolerance
  picture.png             the surfaces as the camera sees them
  position-TOLERANCE.png  error of the triangles' positions, pixel by pixel
  normal-TOLERANCE.png    error of their interpolated normals, pixel by pixel
  legend.svg              the colours of these errors
--against povray: the scene is written for POV-Ray 3.7 with a lamp at the
camera, so that a pixel is the cosine between ray and normal; its bicubic
patches are flat to within each tolerance. The program `povray`, or the one
named by POVRAY, renders it. Spheres, cones, cylinders, disks and tori that are
called so in the scene are written, and polynomial surfaces of degrees up to 3
without trims. All others are left out on both sides, though some would be
primitives of POV-Ray, too; the first twelve for each reason are named. DIR gets
  report.md                 times; errors of brightness; pixels lost and
                            invented
  scene-TOLERANCE.pov       what POV-Ray reads
  picture.png               our picture with the same lamp
  difference-TOLERANCE.png  difference of brightness, pixel by pixel
  legend.svg                the colours of these differences

The rival is given its best case: its scene is moved to the middle of the
model's bounding box and scaled by a power of two, to a size between 1 and 2 (for
POV-Ray larger, if small surfaces would be lost); for Embree, rays that begin far
away are moved along themselves to beside it, in f64.
Rays whose own answer nurbray flags as doubtful are left out and counted. The
report lists the files written with it; other files in DIR stay. All are written
at the end, the report last. Without POV-Ray the command fails, but leaves the
scenes in DIR, to be rendered elsewhere. Everything except times, rates and
memory is the same in every run.

Example:
  nurbray compare scenes/teapot.toml --against embree --tolerance 1e-3,1e-4,1e-5 -o teapot-embree";

/// After those of `plot`.
pub(crate) const PLOT: &str = "\
A scene says with [[plot]] tables what to draw: curves with control polygons and
knots, basis and blending functions, derivatives, hodographs and curvature, knot
insertion, degree elevation, de Casteljau's and de Boor's construction, corner
cutting, the trims of a surface, surfaces as lines in space. What varies in all
three coordinates is seen from an oblique direction, unless the plot says which
plane or view it shows. A scene with plots needs no [[object]].

A scene without any [[plot]], or a bare model, gets the plots that suit it, the
first 24 of them: the curves its surfaces are made from, their trims, triangular
and subdivision surfaces, and those with more functions than can be drawn, as
lines in space, and the basis functions over their knots (up to 1000 of a kind).

The plots of one scene lie side by side in one picture; [figure] says how, and
how large it is. Curves are drawn to within 0.1 pixel. The same input gives the
same bytes.

Example:
  nurbray plot scenes/note_circles.toml -o circles.svg -o circles.png";

/// After those of `info`.
pub(crate) const INFO: &str = "\
Gaps: each border of each surface is sampled at 33 points or more, no farther
apart than about 1/32 of its length, and each point's nearest point on every
other border is found by Newton's method. Two borders run side by side where at
least a quarter of the length of one is near the other: within 1e-3 of the size
of the object they belong to (for borders of two objects, within 1e-3 of the
larger one's size and 1e-2 of the smaller one's), and within 1/20 of the shorter
border's length. They meet if none of these points is farther off than rounding,
4 (p + q + 4) 2^-53 M for each surface. Else the largest distance is listed as a
gap, through which rays may pass; it is measured from points of one border that
no other border meets. Gaps that are shorter than the distance between samples
may be missed. A knot of multiplicity p + 1 within a domain makes two borders,
as the surface may jump there. Trim edges are borders from corner to corner.
Parts of borders that trims cut off do not count, nor parts along which a trim
edge runs, nor do the parts of one tube, ribbon or net, which run into each
other.

Turns: surfaces that meet are turned alike where the borders of both, each run
through with its surface on the left as seen from the tip of S_u x S_v, run
against each other, at whatever angle the surfaces meet. Closed models need
that: at other borders `cast --all` has too many crossings, or too few.
`reverse = true` turns all surfaces of an object; one surface that meets itself
so has parts turned opposite ways or, as a Moebius strip, one side only. Judged
are stretches along which two borders meet to within rounding, or to within
1e-2 of the distance at which they nearly meet (see gaps), and no third one.
Surfaces that lie on each other there, and parts of one tube, ribbon or net, are
not judged.

Bounds: the tight boxes of the surfaces themselves, not of their control points
or leaves, to 1e-12 of their size, or 1.5e-14 of the largest coordinate if that
is more (1e-9 of the size where a surface touches its box along a curve askew to
u and v). The box of a trimmed surface holds its leaves, as far as they lie in
the rectangle of u and v around what is kept; leaves at an edge may reach beyond
it.

With --json one object:
  input, build_seconds
  surfaces       a list, in the order hits count them: index, name, material,
                 degree [p, q], rational, size [nu, nv] (control points; null
                 for triangles and subdivision surfaces), domain
                 [[u0, u1], [v0, v1]], pieces, leaves, bytes (of its control
                 points, trims, pieces and leaves), bounds [min, max],
                 collapsed_edges (a list: edge, point), deviation (how far it
                 may be from what the scene asks for, in units of the scene: 0,
                 or measured where a sweep is approximated, or proved where a
                 subdivision surface is), patches (null, or of a subdivision
                 surface all, exact), trims (null, or keep, loops,
                 loops_outside (as written, that run outside the domain
                 only), segments, widest_gap (that was closed between the
                 curves of a loop, as a part of its extent), bytes,
                 mixed_leaves: those at an edge)
  total          surfaces, control_points, pieces, leaves, bytes (with the
                 hierarchy), bounds
  borders        total, trim_edges (of these), collapsed, meeting,
                 nearly_meeting, free
  turns          judged (pairs of borders), opposite (a list of those with
                 surfaces turned opposite ways: surfaces [i, j], edges,
                 at [x, y, z])
  free_borders   a list, the longest first: surface, edge, length, at [x, y, z]
  gaps           a list, the widest first: surfaces [i, j], edges, width,
                 relative (to the size of the bounding box), at [x, y, z]
  not_imported   a list: file, line, column (null where unknown), what, why

Example:
  nurbray info scenes/teapot.toml";
