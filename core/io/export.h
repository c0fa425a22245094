/* io/export.h - clips and meshes out of the program, in the formats that other tools open. Files
 * are written beside their target and renamed: complete or absent. Positions must be finite. [main]
 * or a worker. */
#ifndef MAROTTE_IO_EXPORT_H
#define MAROTTE_IO_EXPORT_H
#include "io/clip.h"

typedef struct export_progress { /* optional: called now and then; NULL callback: nothing */
    void (*step)(void *data, double done); /* 0..1 */
    void *data;
} export_progress;

typedef struct gltf_options {
    double tolerance_mm; /* greatest vertex error of free frames, and of those with a named part; 0:
                            0.1 % of the face's height, and a tenth of that where all frames have
                            one and what is left is not clay; at least 1e-6 of its size, which is
                            what float32 can show */
    uint32_t max_targets; /* for free frames, in all; 0: as many as the tolerance needs, within the
                             limits of components.h */
    const char *name;     /* of the animation; NULL: "performance" */
    bool is_bare;         /* the mesh alone, also where it was read from a glTF or VRM file */
} gltf_options;

typedef struct gltf_report {
    uint32_t target_count, exact_target_count; /* exact: also those of a named part */
    uint32_t component_count; /* all others: components for free frames and bases of windows */
    uint32_t window_count;    /* of free frames; 0 without any */
    double remainder_mm, mean_remainder_mm; /* of clip_split; 0 where no frame has a named part */
    double max_error_mm; /* over all free frames, measured on what is written; 0 without any */
    double tolerance_mm; /* that was aimed at; max_error_mm is above it only where a limit on the
                            number of components came first */
    uint64_t byte_count;
    error
        why_bare; /* the source file could not be used, so the mesh is there alone; "" it is not */
} gltf_report;

/* .glb. Of a mesh that was read from a glTF or VRM file (mesh.path): that file, with the morph
 * targets and the animation added to what they move, all else as it is; its own animations come
 * behind. Else, or where the file is no longer what was performed: the mesh alone, with parts and
 * materials. Morph targets and a weights animation with a key per frame, every weight within
 * 0..1, as programs that play it limit them to that. Anchored frames exactly (to float32): a target
 * for each direction of a column's axis that is used in a segment, "s1.control2.y+", in metres
 * times a power of two, and one target per committed base, "s2.base". Frames with a named part: a
 * target for each way that a curve goes, "jaw.open" or "eye.l.yaw +" and "eye.l.yaw -", of weight 1
 * at the curve's limit; and for each direction that a control is pulled in, "mouth.corner.l out",
 * of weight 1 at 31.25 mm (or that times a power of two, when it is pulled further); "s2." before
 * it where another engagement moves the face otherwise. What these leave are components, "remainder
 * 1", and so much of max_error_mm; a curve that is a shape of the file itself gives the weights of
 * its own target. The clip's bones are nodes that turn, "bone jaw" under "marotte bones" in a
 * source file, "jaw" else; they carry no skin, as the targets show what they do. Free frames:
 * principal components up to the tolerance, "component1", counted from a "base" (weight 1 in these
 * frames). Where that makes less work and few more bytes, a long motion is split into windows of
 * time, each with a base and components of its own, "w2.base" and "w2.component1"; the weights of
 * others are 0. Each key shows its own shape, and between two keys the shape goes straight from one
 * to the other. Normals follow to first order. A clip without motion is a plain mesh; the mesh's
 * own targets are left out. Parts are primitives on the same vertices, in the file's order, with
 * their name in extras.name. asset.extras has timecode, firstFrame and rate where clip_start_of
 * says. The animation's extras have contentHash, which is another one when anything is that the
 * export shows, and the take: show, id and slate. Errors name the frame or file. */
CHECKED mrt_result gltf_write(const char *path, const clip *c, const gltf_options *options,
                              const export_progress *progress, gltf_report *out_report, error *err);
/* A mesh alone, with its parts, materials, attributes and targets. */
CHECKED mrt_result gltf_write_mesh(const char *path, const mesh *m, error *err);

typedef struct cache_options {
    double mm_per_unit;              /* of what is written; 0: 1 */
    uint32_t first_part, part_count; /* the vertices that triangles of these parts of the mesh use,
                                        in the file's order; 0 parts: all vertices */
} cache_options;
/* Vertex caches, +y up, every frame; a clip without frames is refused. PC2 begins at the frame
 * that clip_start_of says; MDD's times count from its first frame. options: NULL: all, mm. */
CHECKED mrt_result pc2_write(const char *path, const clip *c, const cache_options *options,
                             const export_progress *progress, error *err);
CHECKED mrt_result mdd_write(const char *path, const clip *c, const cache_options *options,
                             const export_progress *progress, error *err);

/* .usda, the text form of OpenUSD; +y up, metersPerUnit as mm_per_unit says, a time code per frame
 * from 0. /Face/Mesh with a GeomSubset for each part and a plain material for each (no pictures).
 * Names are made identifiers, what they were is displayName.
 * usd_write: UsdSkel: gltf_write's targets as blend shapes that list the points they move, their
 * weights in a SkelAnimation, and a skeleton of one joint that stays. options: tolerance_mm and
 * max_targets. usd_write_points: the points of each frame; no normals. */
CHECKED mrt_result usd_write(const char *path, const clip *c, const gltf_options *options,
                             double mm_per_unit, const export_progress *progress,
                             gltf_report *out_report, error *err);
CHECKED mrt_result usd_write_points(const char *path, const clip *c, double mm_per_unit,
                                    const export_progress *progress, error *err);

/* .bvh: the hands that were there, MRT_JOINTS each, in the hand frame of plugin.h: +y out of the
 * back of the hand, +z along the fingers. One root, "Hands", at the origin; then "LeftHand" and
 * "RightHand" with the bones' names of VRM. A wrist that nothing tracks stands 120 mm from the
 * root, the left one at +x. A hand that is gone is held. Refused where no hand ever was there. */
CHECKED mrt_result bvh_write(const char *path, const clip *c, double mm_per_unit,
                             const export_progress *progress, error *err);

/* The table of Live Link Face, of what the clip says in ARKit's names (clip_add_arkit): Timecode as
 * HH:MM:SS:FF.fff, BlendShapeCount, then arkit_name. */
CHECKED mrt_result livelink_write(const char *path, const clip *c, const export_progress *progress,
                                  error *err);

/* .vrma, VRM animation 1.0: the turns of neck, head (a bone "head", else "skull") and jaw, the gaze
 * as the middle of both eyes', and as expressions what the clip says in ARKit's names: each by its
 * name, and aa, blinkLeft and blinkRight. */
CHECKED mrt_result vrma_write(const char *path, const clip *c, const export_progress *progress,
                              error *err);

/* A picture, 8-bit RGBA rows from the top. */
CHECKED mrt_result png_write(const char *path, const uint8_t *rgba, uint32_t width, uint32_t height,
                             error *err);
typedef enum png_kind { PNG_WITH_ALPHA = 0, PNG_OPAQUE /* alpha is left out */ } png_kind;
CHECKED mrt_result png_write_as(const char *path, const uint8_t *rgba, uint32_t width,
                                uint32_t height, png_kind kind, error *err);

#endif
