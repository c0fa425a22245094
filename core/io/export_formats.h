/* io/export_formats.h - the export formats of takes and performances, for command lines, --help and
 * the window. Leaves out the writers: io/write/, called by ui/cli/exports.c. */
#ifndef MAROTTE_IO_EXPORT_FORMATS_H
#define MAROTTE_IO_EXPORT_FORMATS_H

/* X(format, file extension, name of the format, contents, missing contents) */
#define EXPORTS_FORMATS(X)                                                                         \
    X(GLB, ".glb", "glTF, for Blender, Unity, Unreal (.glb)",                                      \
      "the face with all that its file has, and its motion", "hands, sound")                       \
    X(VRM, ".vrm", "VRM (.vrm)", "the .vrm that the face came from, and its motion",               \
      "hands, sound")                                                                              \
    X(VRMA, ".vrma", "VRM animation (.vrma)", "head, jaw, gaze and expressions, for any VRM",      \
      "the mesh, pulls")                                                                           \
    X(MP4, ".mp4", "Video (.mp4)", "H.264, by the program ffmpeg; sound and time code",            \
      "the mesh, transparency")                                                                    \
    X(FOLDER, "/", "Pictures, a folder of PNG", "a folder: pictures 00001.png and on", "sound")    \
    X(USD_POINTS, ".points.usda", "USD, points (.points.usda)",                                    \
      "the mesh, and every vertex at every frame", "shapes to edit; it is large")                  \
    X(USD, ".usda", "USD, blend shapes (.usda)",                                                   \
      "the mesh, blend shapes, their animation (UsdSkel)", "pictures, the file's bones")           \
    X(BVH, ".bvh", "Hands (.bvh)", "the hands, 21 joints each, cm", "the face")                    \
    X(PC2, ".pc2", "Point cache 2 (.pc2)", "every vertex at every frame",                          \
      "the mesh, frames a second")                                                                 \
    X(MDD, ".mdd", "Motion Designer (.mdd)", "every vertex at every frame, and its time",          \
      "the mesh")                                                                                  \
    X(CSV, ".csv", "Table (.csv)", "degrees of freedom and contacts, a row a frame", "the mesh")   \
    X(LIVELINK, ".livelink.csv", "Live Link Face table (.livelink.csv)",                           \
      "ARKit's shapes, as the app records them", "the mesh")                                       \
    X(PNG, ".png", "Contact sheet (.png)", "eight moments in one picture", "motion")

/* Lines for --help, one per format. */
#define EXPORTS_HELP_LINE(format, ending, name, holds, lacks)                                      \
    "      " ending "   " holds "; not: " lacks "\n"
#define EXPORTS_HELP EXPORTS_FORMATS(EXPORTS_HELP_LINE)

#endif
