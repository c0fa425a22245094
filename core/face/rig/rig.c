#include "face/rig.h"

#include "base/arrays.h"
#include "face/rig/rig_document.h"

#include <stdlib.h>
#include <string.h>

static const uint64_t fnv_offset = 14695981039346656037u, fnv_prime = 1099511628211u;

void rig_select_free_ranges(rig_select *select)
{
    free(select->first);
    free(select->last);
    free(select->value);
    select->first = select->last = NULL;
    select->value = NULL;
    select->range_count = 0;
}

void rig_select_finish(rig_select *select)
{
    for (uint32_t i = 0; select->child && i < select->child_count; ++i)
        rig_select_finish(&select->child[i]);
    free(select->child);
    free(select->path);
    free(select->name);
    rig_select_free_ranges(select);
    *select = (rig_select){0};
}

static void free_bones(rig *r)
{
    for (uint32_t i = 0; r->bone && i < r->bone_count; ++i) {
        for (uint32_t k = 0; k < RIG_TURNS_MAX; ++k)
            free(r->bone[i].turn[k].name);
        free(r->bone[i].name);
    }
    free(r->bone);
}

const char *const rig_pose_part_name[POSE_UPPER + 1] = {
    [POSE_MOUTH] = "mouth", [POSE_UPPER] = "upper"};

void rig_pose_finish(rig_pose *pose)
{
    for (uint32_t i = 0; pose->dof_name && i < pose->dof_count; ++i)
        free(pose->dof_name[i]);
    free(pose->dof_name);
    free(pose->dof_value);
    free(pose->pull_contact);
    free(pose->pull_mm);
    free(pose->name);
    *pose = (rig_pose){0};
}

void rig_destroy(rig *r)
{
    if (!r)
        return;
    free_bones(r);
    for (uint32_t i = 0; r->region && i < r->region_count; ++i) {
        rig_select_finish(&r->region[i].select);
        free(r->region[i].name);
    }
    for (uint32_t i = 0; r->contact && i < r->contact_count; ++i)
        free(r->contact[i].name);
    for (uint32_t i = 0; r->pose && i < r->pose_count; ++i)
        rig_pose_finish(&r->pose[i]);
    for (uint32_t i = 0; r->contact_set && i < r->contact_set_count; ++i) {
        free(r->contact_set[i].name);
        free(r->contact_set[i].contact);
    }
    free(r->region);
    free(r->contact);
    free(r->proxy);
    free(r->pose);
    free(r->contact_set);
    free(r->cut_mouth);
    free(r->mouth.upper);
    free(r->mouth.lower);
    free(r->mouth.fault);
    rig_document_destroy(r->document);
    free(r->path);
    free(r->name);
    free(r->mesh_path);
    free(r->note);
    *r = (rig){0};
}

bool rig_find_turn(const rig *r, const char *dof, uint32_t *out_bone, uint32_t *out_turn)
{
    for (uint32_t i = 0; i < r->bone_count; ++i) {
        const rig_bone *bone = &r->bone[i];
        size_t length = strlen(bone->name);
        if (strncmp(dof, bone->name, length) != 0 || dof[length] != '.')
            continue;
        for (uint32_t k = 0; k < bone->turn_count; ++k)
            if (strcmp(dof + length + 1, bone->turn[k].name) == 0) {
                *out_bone = i;
                *out_turn = k;
                return true;
            }
    }
    return false;
}

const char *rig_follow_fault(const rig *r, uint32_t bone, uint32_t turn)
{
    const rig_follow *follows = &r->bone[bone].turn[turn].follows;
    if (follows->share == 0.0)
        return NULL;
    if (!(follows->share >= -1.0 && follows->share <= 1.0))
        return "has a share outside -1 to 1";
    if (follows->bone == bone)
        return "is a turn of the same bone, but must belong to another bone";
    if (follows->bone > bone)
        return "is a turn of a bone that is listed later, but must be listed before";
    if (follows->turn >= r->bone[follows->bone].turn_count)
        return "is not a turn of a ball that is listed before it";
    if (r->bone[follows->bone].turn[follows->turn].follows.share != 0.0)
        return "follows another turn itself, but must not follow any";
    return NULL;
}

double rig_teeth_core(const rig_proxy *proxy)
{
    const double least = proxy->radii.x < proxy->radii.z ? proxy->radii.x : proxy->radii.z;
    const double core = 1.0 - 1.5 * proxy->radii.y / least;
    return proxy->kind == PROXY_TEETH && core > 0.0 ? core : 0.0;
}

uint32_t rig_find_jaw(const rig *r)
{
    for (uint32_t i = 0; i < r->bone_count; ++i)
        if (r->bone[i].kind == BONE_JAW)
            return i;
    return RIG_NONE;
}

uint32_t rig_find_bone(const rig *r, const char *name)
{
    for (uint32_t i = 0; i < r->bone_count; ++i)
        if (strcmp(r->bone[i].name, name) == 0)
            return i;
    return RIG_NONE;
}

uint32_t rig_find_contact(const rig *r, const char *name)
{
    for (uint32_t i = 0; i < r->contact_count; ++i)
        if (strcmp(r->contact[i].name, name) == 0)
            return i;
    return RIG_NONE;
}

const rig_contact_set *rig_find_contact_set(const rig *r, const char *name)
{
    for (uint32_t i = 0; i < r->contact_set_count; ++i)
        if (strcmp(r->contact_set[i].name, name) == 0)
            return &r->contact_set[i];
    return NULL;
}

bool rig_select_uses_paint(const rig_select *select, const char *name)
{
    if (select->kind == SELECT_PAINTED && strcmp(select->name, name) == 0)
        return true;
    for (uint32_t i = 0; i < select->child_count; ++i)
        if (rig_select_uses_paint(&select->child[i], name))
            return true;
    return false;
}

bool rig_region_is_paint(const rig_region *region)
{
    static const char *const prefixes[] = {"painted ", "rigid "};
    const rig_select_kind kind = region->select.kind;
    if (!region->name || (kind != SELECT_VERTICES && kind != SELECT_PAINTED))
        return false;
    for (int i = 0; i < 2; ++i)
        if (strncmp(region->name, prefixes[i], strlen(prefixes[i])) == 0)
            return true;
    return false;
}

static uint64_t hash_word(uint64_t hash, uint32_t word)
{
    for (int byte = 0; byte < 4; ++byte)
        hash = (hash ^ ((word >> (8 * byte)) & 0xffu)) * fnv_prime;
    return hash;
}

uint64_t rig_mesh_hash(uint32_t vertex_count, const uint32_t *triangle, uint32_t triangle_count)
{
    uint64_t hash = hash_word(fnv_offset, vertex_count);
    for (size_t i = 0; i < (size_t)triangle_count * 3; ++i)
        hash = hash_word(hash, triangle[i]);
    return hash;
}

/* ---- copies ---- */

/* Copies `count` items into an array of `capacity`, with the rest zeroed. Rigs allocate room for
 * more bones than they have. */
static void *copy_roomy(copying *c, const void *from, size_t count, size_t capacity,
                        size_t item_size)
{
    void *out = calloc(capacity + 1, item_size);
    c->failed = c->failed || !out;
    c->bytes += (capacity + 1) * item_size;
    if (out && count > 0)
        memcpy(out, from, count * item_size);
    return out;
}

static void copy_select(copying *c, rig_select *out, const rig_select *from)
{
    *out = *from;
    out->path = copy_text(c, from->path);
    out->name = copy_text(c, from->name);
    out->first = copy_array(c, from->first, from->range_count, sizeof *from->first);
    out->last = copy_array(c, from->last, from->range_count, sizeof *from->last);
    out->value = copy_array(c, from->value, from->range_count, sizeof *from->value);
    out->child =
        from->child_count ? copy_roomy(c, NULL, 0, from->child_count, sizeof *out->child) : NULL;
    for (uint32_t i = 0; out->child && i < from->child_count; ++i)
        copy_select(c, &out->child[i], &from->child[i]);
}

static void copy_bones(copying *c, rig *out, const rig *r)
{
    out->bone = copy_roomy(c, r->bone, r->bone_count, RIG_BONES_MAX, sizeof *r->bone);
    for (uint32_t i = 0; out->bone && i < r->bone_count; ++i) {
        out->bone[i].name = copy_text(c, r->bone[i].name);
        for (uint32_t k = 0; k < RIG_TURNS_MAX; ++k)
            out->bone[i].turn[k].name = copy_text(c, r->bone[i].turn[k].name);
    }
}

static void copy_regions(copying *c, rig *out, const rig *r)
{
    out->region = copy_roomy(c, r->region, r->region_count, r->region_count, sizeof *r->region);
    for (uint32_t i = 0; out->region && i < r->region_count; ++i) {
        out->region[i].name = copy_text(c, r->region[i].name);
        copy_select(c, &out->region[i].select, &r->region[i].select);
    }
}

static void copy_contacts(copying *c, rig *out, const rig *r)
{
    out->contact =
        copy_roomy(c, r->contact, r->contact_count, r->contact_count, sizeof *r->contact);
    for (uint32_t i = 0; out->contact && i < r->contact_count; ++i)
        out->contact[i].name = copy_text(c, r->contact[i].name);
}

static void copy_pose(copying *c, rig_pose *out, const rig_pose *from)
{
    uint32_t dof_count = from->dof_count, pull_count = from->pull_count + from->follow_count;
    out->name = copy_text(c, from->name);
    out->dof_name =
        from->dof_name ? copy_roomy(c, NULL, 0, dof_count, sizeof *out->dof_name) : NULL;
    for (uint32_t i = 0; out->dof_name && i < dof_count; ++i)
        out->dof_name[i] = copy_text(c, from->dof_name[i]);
    out->dof_value = copy_array(c, from->dof_value, dof_count, sizeof *from->dof_value);
    out->pull_contact = copy_array(c, from->pull_contact, pull_count, sizeof *from->pull_contact);
    out->pull_mm = copy_array(c, from->pull_mm, pull_count, sizeof *from->pull_mm);
}

static void copy_poses(copying *c, rig *out, const rig *r)
{
    out->pose = copy_roomy(c, r->pose, r->pose_count, r->pose_count, sizeof *r->pose);
    for (uint32_t i = 0; out->pose && i < r->pose_count; ++i)
        copy_pose(c, &out->pose[i], &r->pose[i]);
}

static void copy_sets(copying *c, rig *out, const rig *r)
{
    uint32_t count = r->contact_set_count;
    out->contact_set = copy_roomy(c, r->contact_set, count, count, sizeof *r->contact_set);
    for (uint32_t i = 0; out->contact_set && i < count; ++i) {
        const rig_contact_set *from = &r->contact_set[i];
        out->contact_set[i].name = copy_text(c, from->name);
        out->contact_set[i].contact =
            copy_array(c, from->contact, from->contact_count, sizeof *from->contact);
    }
}

mrt_result rig_copy(rig *out, const rig *r, error *err)
{
    copying c = {.bytes = sizeof *out};
    *out = *r;
    copy_bones(&c, out, r);
    copy_regions(&c, out, r);
    copy_contacts(&c, out, r);
    copy_poses(&c, out, r);
    copy_sets(&c, out, r);
    out->proxy = copy_roomy(&c, r->proxy, r->proxy_count, r->proxy_count, sizeof *r->proxy);
    out->cut_mouth = copy_array(&c, r->cut_mouth, r->cut_mouth_count, sizeof *r->cut_mouth);
    out->mouth.upper = copy_array(&c, r->mouth.upper, r->mouth.upper_count, sizeof(uint32_t));
    out->mouth.lower = copy_array(&c, r->mouth.lower, r->mouth.lower_count, sizeof(uint32_t));
    out->mouth.fault = copy_text(&c, r->mouth.fault);
    out->path = copy_text(&c, r->path);
    out->name = copy_text(&c, r->name);
    out->mesh_path = copy_text(&c, r->mesh_path);
    out->note = copy_text(&c, r->note);
    if (r->document)
        rig_document_retain(r->document);
    out->copied_bytes = c.bytes;
    if (!c.failed)
        return MRT_OK;
    rig_destroy(out);
    return error_set(err, MRT_ERR_MEMORY, "no memory for a copy of the rig");
}
