#include "io/write/clip_targets.h"
#include "base/text.h"
#include "io/write/export_stream.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The text form of OpenUSD, "#usda 1.0". Names of prims are identifiers: other characters of a name
 * are replaced, and the original is kept as the prim's displayName. Matrices act on row vectors,
 * which are multiplied from the left. Quaternions have w first. */

typedef struct usd_file {
    FILE *stream;
    const mesh *mesh;
    double per_mm; /* units of the file per mm */
    int decimals;  /* of lengths */
    char **name;   /* identifiers so far */
    uint32_t name_count, name_capacity;
    uint32_t first_sibling; /* identifiers from this index on must be unique */
    bool is_short;          /* memory ran out */
} usd_file;

/* ---- numbers ---- */

/* Writes a decimal number without a locale, ten times faster than printf. Returns the number of
 * characters. */
static size_t write_fixed(char *out, double value, int decimals)
{
    static const double power[] = {1, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9};
    char digit[24];
    size_t used = 0, count = 0;
    double scaled = fabs(value) * power[decimals] + 0.5;
    if (!(scaled < 1e18))
        return (size_t)snprintf(out, 330, "%.0f", value);
    uint64_t whole = (uint64_t)scaled;
    if (whole == 0) {
        out[0] = '0';
        return 1;
    }
    while (decimals > 0 && whole % 10 == 0) {
        whole /= 10;
        --decimals;
    }
    for (int i = 0; i <= decimals || whole > 0; ++i) {
        if (i > 0 && i == decimals)
            digit[count++] = '.';
        digit[count++] = (char)('0' + whole % 10);
        whole /= 10;
    }
    if (value < 0.0)
        out[used++] = '-';
    while (count > 0)
        out[used++] = digit[--count];
    return used;
}

enum { NUMBER = 340, TUPLE_MAX = 4 };

/* Writes each row of `width` numbers as "(1, 2, 3)", or as plain numbers if `width` is 1. */
static void write_rows(usd_file *self, const float *value, size_t count, size_t width,
                       double factor, int decimals)
{
    char text[NUMBER * TUPLE_MAX + 16];
    fputc('[', self->stream);
    for (size_t i = 0; i < count; ++i) {
        size_t used = 0;
        if (i > 0) {
            text[used++] = ',';
            text[used++] = ' ';
        }
        if (width > 1)
            text[used++] = '(';
        for (size_t k = 0; k < width; ++k) {
            if (k > 0) {
                text[used++] = ',';
                text[used++] = ' ';
            }
            used += write_fixed(text + used, factor * (double)value[i * width + k], decimals);
        }
        if (width > 1)
            text[used++] = ')';
        (void)fwrite(text, 1, used, self->stream);
    }
    fputc(']', self->stream);
}

static void write_lengths(usd_file *self, const float *value_mm, size_t count)
{
    write_rows(self, value_mm, count, 3, self->per_mm, self->decimals);
}

static void write_integers(usd_file *self, const uint32_t *value, size_t count)
{
    char text[16];
    fputc('[', self->stream);
    for (size_t i = 0; i < count; ++i) {
        int used = snprintf(text, sizeof text, i > 0 ? ", %u" : "%u", value[i]);
        (void)fwrite(text, 1, (size_t)used, self->stream);
    }
    fputc(']', self->stream);
}

/* Writes the same integer repeatedly. */
static void write_repeated(usd_file *self, const char *text, size_t count)
{
    fputc('[', self->stream);
    for (size_t i = 0; i < count; ++i)
        fprintf(self->stream, i > 0 ? ", %s" : "%s", text);
    fputc(']', self->stream);
}

/* ---- names ---- */

/* Writes a quoted, printable text, such as the name of a part or target. */
static void write_text(usd_file *self, const char *text)
{
    char shown[512];
    text_copy(shown, sizeof shown, text_view_of(text, strlen(text)));
    fputc('"', self->stream);
    for (const char *at = shown; *at; ++at) {
        if (*at == '"' || *at == '\\')
            fputc('\\', self->stream);
        fputc(*at, self->stream);
    }
    fputc('"', self->stream);
}

static bool is_taken(const usd_file *self, const char *id)
{
    for (uint32_t i = self->first_sibling; i < self->name_count; ++i)
        if (strcmp(self->name[i], id) == 0)
            return true;
    return false;
}

/* Returns a unique identifier for a name, valid until the file is complete. "": no memory. */
static const char *identify(usd_file *self, const char *name, const char *fallback)
{
    char id[96];
    size_t used = 0;
    if (self->name_count == self->name_capacity) {
        uint32_t capacity = self->name_capacity * 2 + 64;
        char **grown = realloc(self->name, capacity * sizeof *grown);
        self->is_short |= grown == NULL;
        if (!grown)
            return "";
        self->name = grown;
        self->name_capacity = capacity;
    }
    const char *from = name && *name ? name : fallback;
    if (*from >= '0' && *from <= '9')
        id[used++] = '_';
    for (; *from && used < 64; ++from) {
        unsigned char letter = (unsigned char)*from;
        bool is_plain = (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
                        (letter >= '0' && letter <= '9');
        if ((letter & 0xc0) != 0x80) /* one for each UTF-8 character */
            id[used++] = is_plain ? (char)letter : '_';
    }
    id[used] = '\0';
    for (uint32_t i = 2; is_taken(self, id); ++i)
        (void)snprintf(id + used, sizeof id - used, "_%u", i);
    char *copy = strdup(id);
    self->is_short |= copy == NULL;
    if (!copy)
        return "";
    self->name[self->name_count++] = copy;
    return copy;
}

/* Writes 'def Mesh "id"' up to its brace, with the original name if it differs from the identifier.
 * schema: API schema to apply; NULL: none. */
static void open_prim(usd_file *self, int depth, const char *type, const char *id, const char *name,
                      const char *schema)
{
    FILE *out = self->stream;
    int in = 4 * depth;
    bool is_renamed = name && *name && strcmp(name, id) != 0;
    fprintf(out, "\n%*sdef %s \"%s\"", in, "", type, id);
    if (schema || is_renamed) {
        fputs(" (\n", out);
        if (is_renamed) {
            fprintf(out, "%*sdisplayName = ", in + 4, "");
            write_text(self, name);
            fputc('\n', out);
        }
        if (schema)
            fprintf(out, "%*sprepend apiSchemas = [\"%s\"]\n", in + 4, "", schema);
        fprintf(out, "%*s)", in, "");
    }
    fprintf(out, "\n%*s{\n", in, "");
}

/* ---- the mesh ---- */

static void write_head(usd_file *self, const clip *c)
{
    const clip_start *start = clip_start_of(c);
    uint32_t frames = clip_frame_count(c);
    fprintf(self->stream, "#usda 1.0\n(\n    customLayerData = {\n"
                          "        string generator = \"marotte " MAROTTE_VERSION "\"\n");
    if (start->rate_num > 0) {
        fputs("        string timecode = ", self->stream);
        write_text(self, start->timecode);
        fprintf(self->stream, "\n        string rate = \"%u/%u\"\n", start->rate_num,
                start->rate_den);
    }
    fprintf(self->stream,
            "    }\n    defaultPrim = \"Face\"\n    endTimeCode = %u\n    framesPerSecond = %.17g\n"
            "    metersPerUnit = %.17g\n    startTimeCode = 0\n    timeCodesPerSecond = %.17g\n"
            "    upAxis = \"Y\"\n)\n",
            frames > 0 ? frames - 1 : 0, clip_fps(c), 0.001 / self->per_mm, clip_fps(c));
}

static void write_extent(usd_file *self)
{
    float bounds[6];
    mesh_bounds(self->mesh, bounds, bounds + 3);
    fputs("        float3[] extent = ", self->stream);
    write_lengths(self, bounds, 2);
    fputc('\n', self->stream);
}

static void write_surface(usd_file *self)
{
    const mesh *m = self->mesh;
    FILE *out = self->stream;
    write_extent(self);
    fputs("        point3f[] points = ", out);
    write_lengths(self, m->position, m->vertex_count);
    fputs("\n        int[] faceVertexCounts = ", out);
    write_repeated(self, "3", m->triangle_count);
    fputs("\n        int[] faceVertexIndices = ", out);
    write_integers(self, m->triangle, (size_t)m->triangle_count * 3);
    fputs("\n        uniform token subsetFamily:materialBind:familyType = \"partition\"\n"
          "        uniform token orientation = \"rightHanded\"\n"
          "        uniform token subdivisionScheme = \"none\"\n",
          out);
    if (m->colour) {
        fputs("        color4f[] primvars:color = ", out);
        write_rows(self, m->colour, m->vertex_count, 4, 1.0, 5);
        fputs(" (\n            interpolation = \"vertex\"\n        )\n", out);
    }
    if (m->uv) {
        float *st = malloc((size_t)m->vertex_count * 2 * sizeof *st);
        self->is_short |= st == NULL;
        for (size_t i = 0; st && i < m->vertex_count; ++i) {
            st[i * 2] = m->uv[i * 2];
            st[i * 2 + 1] = 1.0f - m->uv[i * 2 + 1]; /* from below */
        }
        fputs("        texCoord2f[] primvars:st = ", out);
        write_rows(self, st, st ? m->vertex_count : 0, 2, 1.0, 7);
        fputs(" (\n            interpolation = \"vertex\"\n        )\n", out);
        free(st);
    }
}

/* Writes the triangles of each part and their material. material: identifiers. */
static void write_parts(usd_file *self, const char *const *material)
{
    const mesh *m = self->mesh;
    FILE *out = self->stream;
    for (uint32_t i = 0; i < m->part_count; ++i) {
        const mesh_part *part = &m->part[i];
        const char *id = identify(self, part->name, "part");
        open_prim(self, 2, "GeomSubset", id, part->name, "MaterialBindingAPI");
        fputs("            uniform token elementType = \"face\"\n"
              "            uniform token familyName = \"materialBind\"\n"
              "            int[] indices = [",
              out);
        for (uint32_t t = 0; t < part->triangle_count; ++t)
            fprintf(out, t > 0 ? ", %u" : "%u", part->first_triangle + t);
        fputs("]\n", out);
        if (part->material < m->material_count)
            fprintf(out, "            rel material:binding = </Face/Materials/%s>\n",
                    material[part->material]);
        fputs("        }\n", out);
    }
}

static void write_material(usd_file *self, const mesh_material *made, const char *id)
{
    FILE *out = self->stream;
    open_prim(self, 2, "Material", id, made->name, NULL);
    fprintf(out,
            "            token outputs:surface.connect = "
            "</Face/Materials/%s/Surface.outputs:surface>\n",
            id);
    open_prim(self, 3, "Shader", "Surface", NULL, NULL);
    fprintf(out,
            "                uniform token info:id = \"UsdPreviewSurface\"\n"
            "                color3f inputs:diffuseColor = (%.6g, %.6g, %.6g)\n"
            "                float inputs:roughness = %.6g\n"
            "                float inputs:metallic = %.6g\n"
            "                float inputs:opacity = %.6g\n"
            "                token outputs:surface\n            }\n        }\n",
            (double)made->base_colour[0], (double)made->base_colour[1],
            (double)made->base_colour[2], (double)made->roughness, (double)made->metallic,
            made->alpha == MESH_ALPHA_OPAQUE ? 1.0 : (double)made->base_colour[3]);
}

static void write_materials(usd_file *self, const char **out_id)
{
    open_prim(self, 1, "Scope", "Materials", NULL, NULL);
    for (uint32_t i = 0; i < self->mesh->material_count; ++i) {
        out_id[i] = identify(self, self->mesh->material[i].name, "material");
        write_material(self, &self->mesh->material[i], out_id[i]);
    }
    fputs("    }\n", self->stream);
    self->first_sibling = self->name_count;
}

/* ---- export as blend shapes ---- */

static void write_normals(usd_file *self)
{
    const mesh *m = self->mesh;
    if (!m->normal)
        return;
    fputs("        normal3f[] normals = ", self->stream);
    write_rows(self, m->normal, m->vertex_count, 3, 1.0, 5);
    fputs(" (\n            interpolation = \"vertex\"\n        )\n", self->stream);
}

static void write_shape(usd_file *self, const clip_target *target, const char *id)
{
    FILE *out = self->stream;
    open_prim(self, 2, "BlendShape", id, target->name, NULL);
    fputs("            uniform vector3f[] offsets = ", out);
    write_rows(self, target->offset, target->count, 3, 1000.0 * self->per_mm, self->decimals);
    if (self->mesh->normal) {
        fputs("\n            uniform vector3f[] normalOffsets = ", out);
        write_rows(self, target->normal, target->count, 3, 1.0, 5);
    }
    fputs("\n            uniform int[] pointIndices = ", out);
    write_integers(self, target->vertex, target->count);
    fputs("\n        }\n", out);
}

static void write_tokens(usd_file *self, const char *const *id, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i)
        fprintf(self->stream, i > 0 ? ", \"%s\"" : "[\"%s\"", id[i]);
    fputs(count > 0 ? "]\n" : "[]\n", self->stream);
}

/* Writes a skeleton of one fixed joint, because players of blend shapes require one. */
static void write_skeleton(usd_file *self, const clip_targets *shapes, const char *const *id,
                           uint32_t frame_count)
{
    static const char one[] = "[((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))]";
    FILE *out = self->stream;
    open_prim(self, 1, "Skeleton", "Skeleton", NULL, "SkelBindingAPI");
    fprintf(out,
            "        uniform matrix4d[] bindTransforms = %s\n"
            "        uniform token[] joints = [\"root\"]\n"
            "        uniform token purpose = \"guide\"\n"
            "        uniform matrix4d[] restTransforms = %s\n"
            "        rel skel:animationSource = </Face/Skeleton/Animation>\n\n"
            "        def SkelAnimation \"Animation\"\n        {\n"
            "            uniform token[] joints = [\"root\"]\n"
            "            quatf[] rotations = [(1, 0, 0, 0)]\n"
            "            half3[] scales = [(1, 1, 1)]\n"
            "            float3[] translations = [(0, 0, 0)]\n",
            one, one);
    if (shapes->weight) {
        fputs("            uniform token[] blendShapes = ", out);
        write_tokens(self, id, shapes->count);
        fputs("            float[] blendShapeWeights = ", out);
        write_repeated(self, "0", shapes->count);
        fputs("\n            float[] blendShapeWeights.timeSamples = {\n", out);
        for (uint32_t frame = 0; frame < frame_count; ++frame) {
            fprintf(out, "                %u: ", frame);
            write_rows(self, shapes->weight + (size_t)frame * shapes->count, shapes->count, 1, 1.0,
                       8);
            fputs(",\n", out);
        }
        fputs("            }\n", out);
    }
    fputs("        }\n    }\n", out);
}

static void write_binding(usd_file *self, const clip_targets *shapes, const char *const *id)
{
    FILE *out = self->stream;
    fputs("        matrix4d primvars:skel:geomBindTransform = ((1, 0, 0, 0), (0, 1, 0, 0), "
          "(0, 0, 1, 0), (0, 0, 0, 1))\n        int[] primvars:skel:jointIndices = ",
          out);
    write_repeated(self, "0", self->mesh->vertex_count);
    fputs(" (\n            elementSize = 1\n            interpolation = \"vertex\"\n        )\n"
          "        float[] primvars:skel:jointWeights = ",
          out);
    write_repeated(self, "1", self->mesh->vertex_count);
    fputs(" (\n            elementSize = 1\n            interpolation = \"vertex\"\n        )\n"
          "        rel skel:skeleton = </Face/Skeleton>\n",
          out);
    if (shapes->count == 0)
        return;
    fputs("        uniform token[] skel:blendShapes = ", out);
    write_tokens(self, id, shapes->count);
    for (uint32_t i = 0; i < shapes->count; ++i)
        fprintf(out,
                i > 0 ? ",\n            </Face/Mesh/%s>"
                      : "        rel skel:blendShapeTargets = [\n            </Face/Mesh/%s>",
                id[i]);
    fputs("\n        ]\n", out);
}

/* ---- files ---- */

static void write_shapes_file(usd_file *self, const clip *c, const clip_targets *shapes,
                              const char **material, const char **id)
{
    FILE *out = self->stream;
    write_head(self, c);
    open_prim(self, 0, "SkelRoot", "Face", NULL, "SkelBindingAPI");
    write_materials(self, material);
    for (uint32_t i = 0; i < shapes->count; ++i)
        id[i] = identify(self, shapes->target[i].name, "shape");
    write_skeleton(self, shapes, id, clip_frame_count(c));
    open_prim(self, 1, "Mesh", "Mesh", NULL, "SkelBindingAPI");
    write_surface(self);
    write_normals(self);
    write_binding(self, shapes, id);
    write_parts(self, material);
    for (uint32_t i = 0; i < shapes->count; ++i)
        write_shape(self, &shapes->target[i], id[i]);
    fputs("    }\n}\n", out);
}

static mrt_result write_points(usd_file *self, const clip *c, const export_progress *progress,
                               error *err)
{
    size_t count = (size_t)self->mesh->vertex_count;
    float *position = malloc(count * 3 * sizeof *position);
    mrt_result result = position ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory for a frame");
    fputs("        point3f[] points.timeSamples = {\n", self->stream);
    for (uint32_t frame = 0; result >= 0 && frame < clip_frame_count(c); ++frame) {
        result = clip_read(c, frame, position, err);
        fprintf(self->stream, "            %u: ", frame);
        if (result >= 0)
            write_lengths(self, position, count);
        fputs(",\n", self->stream);
        if (ferror(self->stream))
            break; /* the commit reports the reason */
        export_step(progress, (double)(frame + 1) / (double)clip_frame_count(c));
    }
    fputs("        }\n", self->stream);
    free(position);
    return result;
}

static mrt_result write_points_file(usd_file *self, const clip *c, const char **material,
                                    const export_progress *progress, error *err)
{
    FILE *out = self->stream;
    write_head(self, c);
    open_prim(self, 0, "Xform", "Face", NULL, NULL);
    write_materials(self, material);
    open_prim(self, 1, "Mesh", "Mesh", NULL, NULL);
    write_surface(self);
    mrt_result result = write_points(self, c, progress, err);
    write_parts(self, material);
    fputs("    }\n}\n", out);
    return result;
}

/* Returns the number of decimals that a millionth of the mesh's size needs. */
static int decimals_of(const mesh *m, double per_mm)
{
    float low[3], high[3];
    double size = 0.0;
    int decimals = 0;
    mesh_bounds(m, low, high);
    for (int axis = 0; axis < 3; ++axis)
        size = fmax(size, per_mm * ((double)high[axis] - (double)low[axis]));
    for (double step = 1.0; decimals < 9 && step > 0.5e-6 * size; step *= 0.1)
        ++decimals;
    return decimals;
}

static void usd_finish(usd_file *self)
{
    for (uint32_t i = 0; i < self->name_count; ++i)
        free(self->name[i]);
    free(self->name);
}

/* shapes: NULL: writes points. */
static mrt_result write_usd(const char *path, const clip *c, const clip_targets *shapes,
                            double mm_per_unit, const export_progress *progress, error *err)
{
    const mesh *m = clip_mesh(c);
    usd_file self = {.mesh = m, .per_mm = 1.0 / mm_per_unit};
    self.decimals = decimals_of(m, self.per_mm);
    const char **material = calloc((size_t)m->material_count + 1, sizeof *material);
    const char **id = calloc((size_t)(shapes ? shapes->count : 0) + 1, sizeof *id);
    export_text text;
    mrt_result result = material && id ? export_text_open(&text, path, err)
                                       : error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
    if (result >= 0) {
        self.stream = text.writer.stream;
        if (shapes)
            write_shapes_file(&self, c, shapes, material, id);
        else
            result = write_points_file(&self, c, material, progress, err);
        if (result >= 0 && self.is_short)
            result = error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
        result = export_text_close(&text, result, err);
    }
    free(material);
    free(id);
    usd_finish(&self);
    return result;
}

mrt_result usd_write(const char *path, const clip *c, const gltf_options *options,
                     double mm_per_unit, const export_progress *progress, gltf_report *out_report,
                     error *err)
{
    clip_targets shapes;
    mrt_result result = clip_targets_find(&shapes, c, options, progress, out_report, err);
    if (result < 0) {
        error_prefix(err, path);
        return result;
    }
    result = write_usd(path, c, &shapes, mm_per_unit, progress, err);
    clip_targets_finish(&shapes);
    return result;
}

mrt_result usd_write_points(const char *path, const clip *c, double mm_per_unit,
                            const export_progress *progress, error *err)
{
    mrt_result result = export_check_size(c, path, err);
    return result < 0 ? result : write_usd(path, c, NULL, mm_per_unit, progress, err);
}
