#include "face/rig/rig_document.h"
#include "face/rig/rig_paint.h"

#include <stdlib.h>
#include <string.h>

typedef struct painting { /* the file that is written */
    json_t *paints;
    const rig *r;
    int failed;
} painting;

/* ---- which names are spoken of ---- */

static bool select_names(const rig_select *select, const char *name)
{
    if (select->kind == SELECT_PAINTED && strcmp(select->name, name) == 0)
        return true;
    for (uint32_t i = 0; i < select->child_count; ++i)
        if (select_names(&select->child[i], name))
            return true;
    return false;
}

static bool rig_names(const rig *r, const char *name)
{
    for (uint32_t i = 0; i < r->region_count; ++i)
        if (select_names(&r->region[i].select, name))
            return true;
    return false;
}

/* Nothing that was read is deeper than the parser lets it be. */
static bool json_names(const json_t *select, const char *name)
{
    const char *painted = json_string_value(json_object_get(select, "painted"));
    if (painted && strcmp(painted, name) == 0)
        return true;
    const json_t *list[] = {json_object_get(select, "all"), json_object_get(select, "any")};
    for (int k = 0; k < 2; ++k)
        for (size_t i = 0; i < json_array_size(list[k]); ++i)
            if (json_names(json_array_get(list[k], i), name))
                return true;
    const json_t *other = json_object_get(select, "not");
    return other && json_names(other, name);
}

static bool file_names(const rig_document *d, const char *name)
{
    for (uint32_t i = 0; i < d->entry_count[RIG_REGIONS]; ++i)
        if (json_names(json_object_get(d->entry[RIG_REGIONS][i].node.value, "select"), name))
            return true;
    return false;
}

/* ---- the table ---- */

static bool says_the_same(const rig_node *paint, const rig_select *select)
{
    rig_select before = {0};
    bool same =
        rig_paint_parse(&before, paint, NULL, NULL) >= 0 && rig_paint_equals(&before, select);
    rig_select_finish(&before);
    return same;
}

static void put_paint(painting *p, const rig_select *select)
{
    const rig_document *d = p->r->document;
    uint32_t file = 0;
    rig_node before = {0};
    if (d)
        before = rig_document_paint(d, select->name, &file);
    if (before.value && says_the_same(&before, select)) {
        if (!json_object_get(p->paints, select->name))
            p->failed |= json_object_set_new(p->paints, select->name, json_deep_copy(before.value));
        return;
    }
    p->failed |= json_object_set_new(p->paints, select->name, rig_paint_to_json(select));
}

static void put_paints_of(painting *p, const rig_select *select)
{
    if (select->kind == SELECT_PAINTED)
        put_paint(p, select);
    for (uint32_t i = 0; i < select->child_count; ++i)
        put_paints_of(p, &select->child[i]);
}

/* Paints of regions that are gone go with them; what no region spoke of is somebody's. */
static void drop_forgotten(painting *p)
{
    const rig_document *d = p->r->document;
    void *at = json_object_iter(p->paints);
    while (d && at) {
        const char *name = json_object_iter_key(at);
        bool is_forgotten = !rig_names(p->r, name) && file_names(d, name);
        void *next = json_object_iter_next(p->paints, at);
        if (is_forgotten)
            json_object_del(p->paints, name);
        at = next;
    }
}

/* Those of included files come here too. */
static json_t *start_paints(const rig *r, const json_t *root)
{
    const rig_document *d = r->document;
    const json_t *own = json_object_get(root, "paints");
    json_t *paints = json_is_object(own) ? json_deep_copy(own) : json_object();
    for (uint32_t i = d ? d->file_count : 0; i-- > 0;) {
        json_t *theirs = json_deep_copy(json_object_get(d->file[i].root, "paints"));
        json_object_update_missing(paints, theirs);
        json_decref(theirs);
    }
    return paints;
}

mrt_result rig_write_paints(json_t *root, const rig *r, error *err)
{
    painting p = {start_paints(r, root), r, 0};
    p.failed = p.paints == NULL;
    drop_forgotten(&p);
    for (uint32_t i = 0; i < r->region_count; ++i)
        put_paints_of(&p, &r->region[i].select);
    if (json_object_size(p.paints) > 0)
        p.failed |= json_object_set(root, "paints", p.paints);
    else if (json_is_object(json_object_get(root, "paints")))
        (void)json_object_del(root, "paints");
    json_decref(p.paints);
    return p.failed ? error_set(err, MRT_ERR_MEMORY, "no memory to write the rig") : MRT_OK;
}
