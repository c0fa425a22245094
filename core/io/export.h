/* io/export.h - writes clips and meshes in the formats of other tools. A file is written beside its
 * target and then renamed: it is complete or absent. Positions must be finite. Does not cover the
 * choice of formats (export_formats.h). [main] or a worker. */
#ifndef MAROTTE_IO_EXPORT_H
#define MAROTTE_IO_EXPORT_H
#include "io/clip.h"

typedef struct export_progress { /* optional progress callback, called repeatedly; NULL: none */
    void (*step)(void *data, double done); /* 0..1 */
    void *data;
} export_progress;

typedef struct gltf_options {
    double tolerance_mm;  /* maximum vertex error of free frames and of frames with a named part. 0:
                             0.1 % of the face's height, or a tenth of that if all frames have a
                             named part and the remainder is not clay. At least 1e-6 of the size, the
                             limit of float32 */
    uint32_t max_targets; /* for all free frames together; 0: the number that the tolerance needs,
                             within the limits of components.h */
    const char *name;     /* name of the animation; NULL: "performance" */
    bool is_bare;         /* writes only the mesh, even if it was read from a glTF or VRM file */
} gltf_options;

typedef struct gltf_report {
    uint32_t target_count,
        exact_target_count; /* exact_target_count includes those of a named part */
    uint32_t
        component_count; /* number of other targets: components for free frames, bases of windows */
    uint32_t window_count;                  /* of free frames; 0: no free frames */
    double remainder_mm, mean_remainder_mm; /* from clip_split; 0: no frame has a named part */
    double max_error_mm; /* over all free frames, measured on the written data; 0: no free frames */
    double tolerance_mm; /* tolerance used; max_error_mm exceeds it only if the number of components
                            reached a limit */
    uint64_t byte_count;
    error why_bare; /* reason why the source file was not used and only the mesh was written; "": it
                       was used */
} gltf_report;

/* Writes a .glb.
 *
 * Source: if the mesh was read from a glTF or VRM file (mesh.path), that file is written. Morph
 * targets and the animation are added to the meshes that they move. The rest of it is unchanged,
 * and its own animations follow. Otherwise, or if the file has changed since, only the mesh is
 * written, with parts and materials.
 *
 * Animation: morph targets, and a weights animation with a key per frame. Weights are within 0..1,
 * because players clamp them. Between two keys the shape is interpolated linearly. Normals follow
 * to first order. A clip without motion is a plain mesh, without the mesh's own targets.
 *
 * Anchored frames are exact (to float32). Each used direction of a column's axis in a segment has a
 * target, "s1.control2.y+", in metres times a power of two. Each committed base has one, "s2.base".
 *
 * Frames with a named part: each direction of a curve has a target, "jaw.open" or "eye.l.yaw +" and
 * "eye.l.yaw -", with weight 1 at the limit of the curve. Each direction of a pulled control has
 * one, "mouth.corner.l out", with weight 1 at 31.25 mm, times a power of two for longer pulls. The
 * prefix "s2." marks a segment that moves the face differently. The remainder becomes components,
 * "remainder 1", within max_error_mm. A curve that is a shape of the source file animates the
 * file's own target.
 *
 * Bones of the clip are rotating nodes: "bone jaw" under "marotte bones" in a source file, else
 * "jaw". They have no skin, because the targets already show their effect.
 *
 * Free frames: principal components up to the tolerance, "component1", relative to a "base" (weight
 * 1 in these frames). A long motion is split into windows of time if that saves work for few more
 * bytes. Each window has its own base and components, "w2.base" and "w2.component1"; the weights of
 * other windows are 0.
 *
 * Parts are primitives on the same vertices, in the order of the file, with their name in
 * extras.name. asset.extras has timecode, firstFrame and rate from clip_start_of. The animation's
 * extras have contentHash, which changes with any content of the export, and the take: show, id and
 * slate. Errors name the frame or file. */
CHECKED mrt_result gltf_write(const char *path, const clip *c, const gltf_options *options,
                              const export_progress *progress, gltf_report *out_report, error *err);
/* Writes only a mesh, with its parts, materials, attributes and targets: the same bytes in every
 * version of marotte, because takes know the heads of rigs/ by the hash of their file. */
CHECKED mrt_result gltf_write_mesh(const char *path, const mesh *m, error *err);

typedef struct cache_options {
    double mm_per_unit;              /* unit of the written file; 0: 1 */
    uint32_t first_part, part_count; /* the vertices that triangles of these parts of the mesh use,
                                        in the file's order; 0 parts: all vertices */
} cache_options;
/* Write vertex caches, +y up, with every frame. A clip without frames is refused. PC2 starts at the
 * frame of clip_start_of. MDD's times are relative to its first frame. options: NULL: all vertices,
 * mm. */
CHECKED mrt_result pc2_write(const char *path, const clip *c, const cache_options *options,
                             const export_progress *progress, error *err);
CHECKED mrt_result mdd_write(const char *path, const clip *c, const cache_options *options,
                             const export_progress *progress, error *err);

/* Write .usda, the text form of OpenUSD: +y up, metersPerUnit from mm_per_unit, a time code per
 * frame from 0. /Face/Mesh has a GeomSubset and a plain material for each part (no pictures). Names
 * are converted to identifiers; displayName keeps the original.
 * usd_write uses UsdSkel: the targets of gltf_write as blend shapes that list their points, their
 * weights in a SkelAnimation, and a skeleton of one fixed joint. options: tolerance_mm and
 * max_targets. usd_write_points writes the points of each frame, without normals. */
CHECKED mrt_result usd_write(const char *path, const clip *c, const gltf_options *options,
                             double mm_per_unit, const export_progress *progress,
                             gltf_report *out_report, error *err);
CHECKED mrt_result usd_write_points(const char *path, const clip *c, double mm_per_unit,
                                    const export_progress *progress, error *err);

/* Writes .bvh: the hands of the clip, MRT_JOINTS each, in the hand frame of plugin.h: +y out of the
 * back of the hand, +z along the fingers. The root "Hands" is at the origin. Below it are
 * "LeftHand" and "RightHand", with the bone names of VRM. An untracked wrist is 120 mm from the
 * root, the left one at +x. A hand that disappears keeps its pose. A clip without any hand is
 * refused. */
CHECKED mrt_result bvh_write(const char *path, const clip *c, double mm_per_unit,
                             const export_progress *progress, error *err);

/* Writes the table of Live Link Face, from the values of clip_add_arkit: Timecode as
 * HH:MM:SS:FF.fff, BlendShapeCount, then arkit_name. */
CHECKED mrt_result livelink_write(const char *path, const clip *c, const export_progress *progress,
                                  error *err);

/* Writes .vrma, VRM animation 1.0: the rotations of neck, head (a bone "head", else "skull") and
 * jaw, the gaze as the mean of both eyes, and the values of clip_add_arkit as expressions: each by
 * its name, and aa, blinkLeft and blinkRight. */
CHECKED mrt_result vrma_write(const char *path, const clip *c, const export_progress *progress,
                              error *err);

/* Writes a picture, 8-bit RGBA, rows from the top. */
CHECKED mrt_result png_write(const char *path, const uint8_t *rgba, uint32_t width, uint32_t height,
                             error *err);
typedef enum png_kind { PNG_WITH_ALPHA = 0, PNG_OPAQUE /* alpha is left out */ } png_kind;
CHECKED mrt_result png_write_as(const char *path, const uint8_t *rgba, uint32_t width,
                                uint32_t height, png_kind kind, error *err);

#endif
