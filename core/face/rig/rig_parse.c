#include "face/rig.h"

#include "base/file.h"
#include "base/text.h"
#include "face/rig/rig_document.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MESH_NAME_MAX = 1024, HASH_DIGITS = 16 };

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory for the rig");
}

/* ---- what it is ---- */

static const char *const root_keys[] = {"marotte_rig",   "name",      "mesh",        "unit",
                                        "mesh_vertices", "mesh_hash", "include",     "bones",
                                        "regions",       "contacts",  "skull_proxy", "poses",
                                        "contact_sets",  "solver",    "paints",      NULL};

/* "rigs/moai/moai.rig.json" is called "moai". */
static char *name_from_path(const char *path)
{
    const char *slash = strrchr(path, '/');
    const char *base = slash ? slash + 1 : path;
    size_t length = strcspn(base, ".");
    char *name = malloc(length + 1);
    if (!name)
        return NULL;
    memcpy(name, base, length);
    name[length] = '\0';
    text_make_printable(name);
    return name;
}

static mrt_result fill_name(rig *r, rig_document *d, error *err)
{
    uint32_t file;
    rig_node name = rig_document_scalar(d, "name", &file);
    if (name.value)
        return rig_json_text(&r->name, &name, "a name", RIG_NAME_MAX, err);
    r->name = name_from_path(r->path);
    return r->name ? MRT_OK : no_memory(err);
}

static mrt_result check_name(const rig *r, error *err)
{
    char *folder = file_directory(r->path);
    mrt_result result = folder ? file_check_below(folder, r->mesh_path, err) : no_memory(err);
    free(folder);
    return result;
}

static mrt_result fill_mesh_path(rig *r, const rig_document *d, error *err)
{
    uint32_t file;
    char *name = NULL;
    rig_node mesh = rig_document_scalar(d, "mesh", &file);
    if (!mesh.value)
        return error_set(err, MRT_ERR_FORMAT,
                         "$.mesh: expected the name of the mesh's file, found nothing; write "
                         "\"mesh\": \"head.glb\"");
    mrt_result result =
        rig_json_text(&name, &mesh, "the name of the mesh's file", MESH_NAME_MAX, err);
    if (result < 0)
        return result;
    char *directory = file_directory(d->file[file].path);
    size_t size = strlen(name) + (directory ? strlen(directory) : 0) + 1;
    r->mesh_path = directory ? malloc(size) : NULL;
    if (r->mesh_path)
        (void)snprintf(r->mesh_path, size, "%s%s", name[0] == '/' ? "" : directory, name);
    free(directory);
    free(name);
    if (!r->mesh_path)
        return no_memory(err);
    if (!d->is_trusted)
        result = check_name(r, err);
    if (result < 0)
        error_prefix(err, mesh.place.text);
    return result;
}

static mrt_result fill_hash(rig *r, const rig_node *at, error *err)
{
    const char *text = json_string_value(at->value);
    if (!text || strlen(text) != HASH_DIGITS || strspn(text, "0123456789abcdef") != HASH_DIGITS)
        return rig_json_unexpected(err, at, "16 digits 0-9a-f as marotte rig new writes them");
    r->mesh_hash = strtoull(text, NULL, 16);
    return MRT_OK;
}

static mrt_result fill_mesh(rig *r, rig_document *d, error *err)
{
    uint32_t file;
    mrt_result result = fill_mesh_path(r, d, err);
    rig_node count = rig_document_scalar(d, "mesh_vertices", &file);
    if (result >= 0 && count.value)
        result = rig_json_index(&r->mesh_vertex_count, &count, err);
    rig_node hash = rig_document_scalar(d, "mesh_hash", &file);
    if (result >= 0 && hash.value)
        result = fill_hash(r, &hash, err);
    return result;
}

static mrt_result fill_solver_word(rig *r, const rig_node *solver, const char *key, error *err)
{
    rig_node at = rig_json_member(solver, key);
    const char *word = json_string_value(at.value);
    bool is_kernel = strcmp(key, "kernel") == 0;
    if (!at.value || (word && (is_kernel ? csrbf_kernel_named(word, &r->solver.kernel)
                                         : csrbf_polynomial_named(word, &r->solver.polynomial))))
        return MRT_OK;
    return rig_json_unexpected(err, &at,
                               is_kernel
                                   ? "one of wendland_c2, wendland_c0, wendland_c4, wendland_c6"
                                   : "one of none, constant, linear, windowed");
}

static mrt_result fill_solver(rig *r, rig_document *d, error *err)
{
    static const char *const known[] = {"kernel", "polynomial", "radius_mm", "ridge", NULL};
    uint32_t file;
    rig_node solver = rig_document_scalar(d, "solver", &file);
    if (!solver.value)
        return MRT_OK;
    mrt_result result = rig_json_object(&solver, "an object with kernel and radius_mm", err);
    if (result < 0)
        return result;
    rig_json_note_unknown(&r->note, &solver, known);
    result = fill_solver_word(r, &solver, "kernel", err);
    if (result >= 0)
        result = fill_solver_word(r, &solver, "polynomial", err);
    if (result >= 0)
        result = rig_json_optional_number(&r->solver.radius, &solver, "radius_mm", 0.01, 1e6, err);
    if (result >= 0)
        result = rig_json_optional_number(&r->solver.ridge, &solver, "ridge", 0.0, 1e3, err);
    return result;
}

/* ---- regions ---- */

static mrt_result find_bone(uint32_t *out, const rig *r, const rig_node *at, error *err)
{
    const char *name = json_string_value(at->value);
    if (!name)
        return rig_json_unexpected(err, at, "the name of a bone");
    *out = rig_find_bone(r, name);
    if (*out != RIG_NONE)
        return MRT_OK;
    rig_word word = rig_word_of(name);
    return error_set(err, MRT_ERR_FORMAT, "%s: there is no bone \"%s\"; add it to $.bones",
                     at->place.text, word.text);
}

static mrt_result check_region(const rig_region *region, const rig_node *at, error *err)
{
    bool has_weight = !isnan(region->weight), has_mobility = !isnan(region->mobility);
    if (region->is_rigid && (has_weight || has_mobility))
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: rigid means weight 1 and mobility 0; leave weight and mobility away",
                         at->place.text);
    if (!region->is_rigid && !has_weight && !has_mobility)
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: expected \"rigid\": true, \"weight\" or \"mobility\": this region "
                         "says nothing",
                         at->place.text);
    if (region->bone == RIG_NONE && (region->is_rigid || has_weight))
        return error_set(err, MRT_ERR_FORMAT,
                         "%s.bone: expected the name of the bone that these vertices ride on",
                         at->place.text);
    return MRT_OK;
}

/* A name is for people: one that is none of ours to show is kept in the file. */
static void fill_region_name(rig_region *region, const rig_node *at)
{
    rig_node name = rig_json_member(at, "name");
    if (name.value && rig_json_text(&region->name, &name, "a name", RIG_NAME_MAX, NULL) < 0)
        region->name = NULL;
}

static mrt_result fill_region(rig *r, rig_region *region, const rig_node *at, rig_selecting *s,
                              error *err)
{
    static const char *const known[] = {"name",     "bone",   "rigid", "weight",
                                        "mobility", "select", NULL};
    *region = (rig_region){.bone = RIG_NONE, .weight = (double)NAN, .mobility = (double)NAN};
    rig_json_note_unknown(&r->note, at, known);
    fill_region_name(region, at);
    rig_node bone = rig_json_member(at, "bone"), is_rigid = rig_json_member(at, "rigid");
    mrt_result result = bone.value ? find_bone(&region->bone, r, &bone, err) : MRT_OK;
    if (result >= 0 && is_rigid.value)
        result = rig_json_flag(&region->is_rigid, &is_rigid, err);
    if (result >= 0)
        result = rig_json_optional_number(&region->weight, at, "weight", 0.0, 1.0, err);
    if (result >= 0)
        result = rig_json_optional_number(&region->mobility, at, "mobility", 0.0, 1.0, err);
    if (result >= 0)
        result = check_region(region, at, err);
    rig_node select = rig_json_member(at, "select");
    return result < 0 ? result : rig_select_parse(&region->select, &select, s, err);
}

static mrt_result fill_regions(rig *r, rig_document *d, error *err)
{
    rig_selecting s = {.note = &r->note, .document = d, .budget = &d->budget};
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; result >= 0 && i < d->entry_count[RIG_REGIONS]; ++i) {
        const rig_entry *entry = &d->entry[RIG_REGIONS][i];
        s.mm_per_unit = d->file[entry->file].mm_per_unit;
        r->region_count = i + 1;
        result = fill_region(r, &r->region[i], &entry->node, &s, err);
        r->region[i].source = i + 1;
    }
    return result;
}

/* ---- contacts ---- */

static mrt_result fill_contact(rig *r, rig_contact *contact, const rig_node *at, error *err)
{
    static const char *const known[] = {"name", "bone", "vertex", "mirror", NULL};
    *contact = (rig_contact){.bone = RIG_NONE, .mirror = RIG_NONE};
    rig_json_note_unknown(&r->note, at, known);
    rig_node name = rig_json_member(at, "name"), bone = rig_json_member(at, "bone");
    rig_node vertex = rig_json_member(at, "vertex");
    mrt_result result =
        rig_json_text(&contact->name, &name, "a name like \"chin\"", RIG_NAME_MAX, err);
    if (result >= 0)
        result = rig_json_index(&contact->vertex, &vertex, err);
    const char *word = json_string_value(bone.value);
    bool is_auto = !bone.value || (word && strcmp(word, "auto") == 0);
    return result < 0 || is_auto ? result : find_bone(&contact->bone, r, &bone, err);
}

static mrt_result find_mirror(rig *r, uint32_t index, const rig_node *contact, error *err)
{
    rig_node at = rig_json_member(contact, "mirror");
    if (!at.value)
        return MRT_OK;
    const char *name = json_string_value(at.value);
    if (!name)
        return rig_json_unexpected(err, &at, "the name of a contact");
    r->contact[index].mirror = rig_find_contact(r, name);
    if (r->contact[index].mirror != RIG_NONE)
        return MRT_OK;
    rig_word word = rig_word_of(name);
    return error_set(err, MRT_ERR_FORMAT,
                     "%s: there is no contact \"%s\"; add it to $.contacts or leave the mirror "
                     "away",
                     at.place.text, word.text);
}

static mrt_result check_mirrors(const rig *r, error *err)
{
    for (uint32_t i = 0; i < r->contact_count; ++i) {
        uint32_t other = r->contact[i].mirror;
        if (other == RIG_NONE || r->contact[other].mirror == i)
            continue;
        rig_place place = rig_where(r, RIG_CONTACTS, i);
        rig_place other_place = rig_where(r, RIG_CONTACTS, other);
        return error_set(err, MRT_ERR_FORMAT,
                         "%s.mirror: \"%s\" does not point back; write \"mirror\": \"%s\" at %s",
                         place.text, r->contact[other].name, r->contact[i].name, other_place.text);
    }
    return MRT_OK;
}

static mrt_result fill_contacts(rig *r, rig_document *d, error *err)
{
    const rig_entry *entry = d->entry[RIG_CONTACTS];
    uint32_t count = d->entry_count[RIG_CONTACTS];
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; result >= 0 && i < count; ++i) {
        result = fill_contact(r, &r->contact[i], &entry[i].node, err);
        r->contact[i].source = i + 1;
        r->contact_count = i + 1;
    }
    for (uint32_t i = 0; result >= 0 && i < count; ++i)
        result = find_mirror(r, i, &entry[i].node, err);
    return result < 0 ? result : check_mirrors(r, err);
}

/* ---- skull proxy ---- */

static mrt_result fill_proxy(rig *r, rig_proxy *proxy, const rig_node *at, double mm_per_unit,
                             error *err)
{
    static const char *const known[] = {"ellipsoid", NULL};
    static const char *const known_inside[] = {"centre", "radii", "bone", NULL};
    rig_node ellipsoid = rig_json_member(at, "ellipsoid");
    mrt_result result = rig_json_object(&ellipsoid, "an object with centre, radii and bone", err);
    if (result < 0)
        return result;
    rig_json_note_unknown(&r->note, at, known);
    rig_json_note_unknown(&r->note, &ellipsoid, known_inside);
    rig_node centre = rig_json_member(&ellipsoid, "centre");
    rig_node radii = rig_json_member(&ellipsoid, "radii");
    rig_node bone = rig_json_member(&ellipsoid, "bone");
    result = rig_json_point(&proxy->centre, &centre, mm_per_unit, err);
    if (result >= 0)
        result = rig_json_point(&proxy->radii, &radii, mm_per_unit, err);
    if (result < 0)
        return result;
    if (!(proxy->radii.x > 0.0 && proxy->radii.y > 0.0 && proxy->radii.z > 0.0))
        return error_set(err, MRT_ERR_FORMAT, "%s: expected three radii above 0", radii.place.text);
    return find_bone(&proxy->bone, r, &bone, err);
}

static mrt_result fill_proxies(rig *r, rig_document *d, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; result >= 0 && i < d->entry_count[RIG_PROXIES]; ++i) {
        const rig_entry *entry = &d->entry[RIG_PROXIES][i];
        r->proxy_count = i + 1;
        r->proxy[i].source = i + 1;
        result = fill_proxy(r, &r->proxy[i], &entry->node, d->file[entry->file].mm_per_unit, err);
    }
    return result;
}

/* ---- all of it ---- */

static mrt_result allocate(rig *r, rig_document *d, error *err)
{
    r->bone = calloc(RIG_BONES_MAX, sizeof *r->bone);
    r->region = calloc(d->entry_count[RIG_REGIONS] + 1u, sizeof *r->region);
    r->contact = calloc(d->entry_count[RIG_CONTACTS] + 1u, sizeof *r->contact);
    r->proxy = calloc(d->entry_count[RIG_PROXIES] + 1u, sizeof *r->proxy);
    r->pose = calloc(d->entry_count[RIG_POSES] + 1u, sizeof *r->pose);
    r->contact_set = calloc(d->entry_count[RIG_SETS] + 1u, sizeof *r->contact_set);
    return r->bone && r->region && r->contact && r->proxy && r->pose && r->contact_set
               ? MRT_OK
               : no_memory(err);
}

static void note_unknown_roots(rig *r, const rig_document *d)
{
    for (uint32_t i = 0; i < d->file_count; ++i) {
        rig_node root = {d->file[i].root, d->file[i].place};
        rig_json_note_unknown(&r->note, &root, root_keys);
    }
}

mrt_result rig_fill(rig *r, rig_document *d, error *err)
{
    static mrt_result (*const steps[])(rig *, rig_document *, error *) = {
        allocate,     fill_name,     fill_mesh,    fill_solver,    rig_fill_bones,
        fill_regions, fill_contacts, fill_proxies, rig_fill_poses, rig_fill_contact_sets};
    r->mm_per_unit = d->file[d->file_count - 1].mm_per_unit;
    note_unknown_roots(r, d);
    mrt_result result = MRT_OK;
    for (size_t i = 0; result >= 0 && i < sizeof steps / sizeof *steps; ++i)
        result = steps[i](r, d, err);
    return result;
}
