#include "io/write/clip_targets.h"
#include "base/text.h"
#include "io/write/export_stream.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The text form of OpenUSD, "#usda 1.0". Names of prims are identifiers: what a name has beside is
 * replaced, and the name itself is kept as the prim's displayName. Matrices are rows that vectors
 * are multiplied with from the left; quaternions have w first. */

typedef struct usd_file {
    FILE *stream;
    const mesh *mesh;
    double per_mm; /* units of the file in a mm */
    int decimals;  /* of lengths */
    char **name;   /* identifiers so far */
    uint32_t name_count, name_capacity;
    uint32_t first_sibling; /* of those from here on no two are alike */
    bool is_short;          /* of memory */
} usd_file;

/* ---- numbers ---- */

/* Decimals without a locale, and ten times faster than printf. Returns how many letters. */
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

/* "(1, 2, 3)" of each row of `width` numbers; plain numbers where that is 1. */
static void put_rows(usd_file *self, const float *value, size_t count, size_t width, double factor,
                     int decimals)
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

static void put_lengths(usd_file *self, const float *value_mm, size_t count)
{
    put_rows(self, value_mm, count, 3, self->per_mm, self->decimals);
}

static void put_integers(usd_file *self, const uint32_t *value, size_t count)
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
static void put_repeated(usd_file *self, const char *text, size_t count)
{
    fputc('[', self->stream);
    for (size_t i = 0; i < count; ++i)
        fprintf(self->stream, i > 0 ? ", %s" : "%s", text);
    fputc(']', self->stream);
}

/* ---- names ---- */

/* A text in quotes: any name of a part or target, made printable. */
static void put_text(usd_file *self, const char *text)
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

/* An identifier of its own for a name, until the file is done; "" without memory. */
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
        if ((letter & 0xc0) != 0x80) /* one for each letter of UTF-8 */
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

/* 'def Mesh "id"' with what a name was before it was an identifier, and up to its brace. schema:
 * NULL: none is applied. */
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
            put_text(self, name);
            fputc('\n', out);
        }
        if (schema)
            fprintf(out, "%*sprepend apiSchemas = [\"%s\"]\n", in + 4, "", schema);
        fprintf(out, "%*s)", in, "");
    }
    fprintf(out, "\n%*s{\n", in, "");
}

/* ---- the mesh ---- */

static void put_head(usd_file *self, const clip *c)
{
    const clip_start *start = clip_start_of(c);
    uint32_t frames = clip_frame_count(c);
    fprintf(self->stream, "#usda 1.0\n(\n    customLayerData = {\n"
                          "        string generator = \"marotte " MAROTTE_VERSION "\"\n");
    if (start->rate_num > 0) {
        fputs("        string timecode = ", self->stream);
        put_text(self, start->timecode);
        fprintf(self->stream, "\n        string rate = \"%u/%u\"\n", start->rate_num,
                start->rate_den);
    }
    fprintf(self->stream,
            "    }\n    defaultPrim = \"Face\"\n    endTimeCode = %u\n    framesPerSecond = %.17g\n"
            "    metersPerUnit = %.17g\n    startTimeCode = 0\n    timeCodesPerSecond = %.17g\n"
            "    upAxis = \"Y\"\n)\n",
            frames > 0 ? frames - 1 : 0, clip_fps(c), 0.001 / self->per_mm, clip_fps(c));
}

static void put_extent(usd_file *self)
{
    float bounds[6];
    mesh_bounds(self->mesh, bounds, bounds + 3);
    fputs("        float3[] extent = ", self->stream);
    put_lengths(self, bounds, 2);
    fputc('\n', self->stream);
}

static void put_surface(usd_file *self)
{
    const mesh *m = self->mesh;
    FILE *out = self->stream;
    put_extent(self);
    fputs("        point3f[] points = ", out);
    put_lengths(self, m->position, m->vertex_count);
    fputs("\n        int[] faceVertexCounts = ", out);
    put_repeated(self, "3", m->triangle_count);
    fputs("\n        int[] faceVertexIndices = ", out);
    put_integers(self, m->triangle, (size_t)m->triangle_count * 3);
    fputs("\n        uniform token subsetFamily:materialBind:familyType = \"partition\"\n"
          "        uniform token orientation = \"rightHanded\"\n"
          "        uniform token subdivisionScheme = \"none\"\n",
          out);
    if (m->colour) {
        fputs("        color4f[] primvars:color = ", out);
        put_rows(self, m->colour, m->vertex_count, 4, 1.0, 5);
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
        put_rows(self, st, st ? m->vertex_count : 0, 2, 1.0, 7);
        fputs(" (\n            interpolation = \"vertex\"\n        )\n", out);
        free(st);
    }
}

/* The triangles of each part, and what they are made of. material: ids. */
static void put_parts(usd_file *self, const char *const *material)
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

static void put_material(usd_file *self, const mesh_material *made, const char *id)
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

static void put_materials(usd_file *self, const char **out_id)
{
    open_prim(self, 1, "Scope", "Materials", NULL, NULL);
    for (uint32_t i = 0; i < self->mesh->material_count; ++i) {
        out_id[i] = identify(self, self->mesh->material[i].name, "material");
        put_material(self, &self->mesh->material[i], out_id[i]);
    }
    fputs("    }\n", self->stream);
    self->first_sibling = self->name_count;
}

/* ---- as blend shapes ---- */

static void put_normals(usd_file *self)
{
    const mesh *m = self->mesh;
    if (!m->normal)
        return;
    fputs("        normal3f[] normals = ", self->stream);
    put_rows(self, m->normal, m->vertex_count, 3, 1.0, 5);
    fputs(" (\n            interpolation = \"vertex\"\n        )\n", self->stream);
}

static void put_shape(usd_file *self, const clip_target *target, const char *id)
{
    FILE *out = self->stream;
    open_prim(self, 2, "BlendShape", id, target->name, NULL);
    fputs("            uniform vector3f[] offsets = ", out);
    put_rows(self, target->offset, target->count, 3, 1000.0 * self->per_mm, self->decimals);
    if (self->mesh->normal) {
        fputs("\n            uniform vector3f[] normalOffsets = ", out);
        put_rows(self, target->normal, target->count, 3, 1.0, 5);
    }
    fputs("\n            uniform int[] pointIndices = ", out);
    put_integers(self, target->vertex, target->count);
    fputs("\n        }\n", out);
}

static void put_tokens(usd_file *self, const char *const *id, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i)
        fprintf(self->stream, i > 0 ? ", \"%s\"" : "[\"%s\"", id[i]);
    fputs(count > 0 ? "]\n" : "[]\n", self->stream);
}

/* Writes a skeleton of one fixed joint, because players of blend shapes require one. */
static void put_skeleton(usd_file *self, const clip_targets *shapes, const char *const *id,
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
        put_tokens(self, id, shapes->count);
        fputs("            float[] blendShapeWeights = ", out);
        put_repeated(self, "0", shapes->count);
        fputs("\n            float[] blendShapeWeights.timeSamples = {\n", out);
        for (uint32_t frame = 0; frame < frame_count; ++frame) {
            fprintf(out, "                %u: ", frame);
            put_rows(self, shapes->weight + (size_t)frame * shapes->count, shapes->count, 1, 1.0,
                     8);
            fputs(",\n", out);
        }
        fputs("            }\n", out);
    }
    fputs("        }\n    }\n", out);
}

static void put_binding(usd_file *self, const clip_targets *shapes, const char *const *id)
{
    FILE *out = self->stream;
    fputs("        matrix4d primvars:skel:geomBindTransform = ((1, 0, 0, 0), (0, 1, 0, 0), "
          "(0, 0, 1, 0), (0, 0, 0, 1))\n        int[] primvars:skel:jointIndices = ",
          out);
    put_repeated(self, "0", self->mesh->vertex_count);
    fputs(" (\n            elementSize = 1\n            interpolation = \"vertex\"\n        )\n"
          "        float[] primvars:skel:jointWeights = ",
          out);
    put_repeated(self, "1", self->mesh->vertex_count);
    fputs(" (\n            elementSize = 1\n            interpolation = \"vertex\"\n        )\n"
          "        rel skel:skeleton = </Face/Skeleton>\n",
          out);
    if (shapes->count == 0)
        return;
    fputs("        uniform token[] skel:blendShapes = ", out);
    put_tokens(self, id, shapes->count);
    for (uint32_t i = 0; i < shapes->count; ++i)
        fprintf(out,
                i > 0 ? ",\n            </Face/Mesh/%s>"
                      : "        rel skel:blendShapeTargets = [\n            </Face/Mesh/%s>",
                id[i]);
    fputs("\n        ]\n", out);
}

/* ---- files ---- */

static void put_shapes_file(usd_file *self, const clip *c, const clip_targets *shapes,
                            const char **material, const char **id)
{
    FILE *out = self->stream;
    put_head(self, c);
    open_prim(self, 0, "SkelRoot", "Face", NULL, "SkelBindingAPI");
    put_materials(self, material);
    for (uint32_t i = 0; i < shapes->count; ++i)
        id[i] = identify(self, shapes->target[i].name, "shape");
    put_skeleton(self, shapes, id, clip_frame_count(c));
    open_prim(self, 1, "Mesh", "Mesh", NULL, "SkelBindingAPI");
    put_surface(self);
    put_normals(self);
    put_binding(self, shapes, id);
    put_parts(self, material);
    for (uint32_t i = 0; i < shapes->count; ++i)
        put_shape(self, &shapes->target[i], id[i]);
    fputs("    }\n}\n", out);
}

static mrt_result put_points(usd_file *self, const clip *c, const export_progress *progress,
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
            put_lengths(self, position, count);
        fputs(",\n", self->stream);
        if (ferror(self->stream))
            break; /* commit says why */
        export_step(progress, (double)(frame + 1) / (double)clip_frame_count(c));
    }
    fputs("        }\n", self->stream);
    free(position);
    return result;
}

static mrt_result put_points_file(usd_file *self, const clip *c, const char **material,
                                  const export_progress *progress, error *err)
{
    FILE *out = self->stream;
    put_head(self, c);
    open_prim(self, 0, "Xform", "Face", NULL, NULL);
    put_materials(self, material);
    open_prim(self, 1, "Mesh", "Mesh", NULL, NULL);
    put_surface(self);
    mrt_result result = put_points(self, c, progress, err);
    put_parts(self, material);
    fputs("    }\n}\n", out);
    return result;
}

/* Returns the number of decimals that shows a millionth of the mesh's size. */
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

/* shapes: NULL: as points. */
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
            put_shapes_file(&self, c, shapes, material, id);
        else
            result = put_points_file(&self, c, material, progress, err);
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
