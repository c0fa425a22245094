/* hands/memory.h - what a mapping remembers as bytes and back, for MRT_RESUME: each variable with
 * what it may hold, so that one list serves both ways. The bytes name the plugin type and carry a
 * sum; whatever else comes changes nothing. Leaves out what depends on several variables together.
 * Little-endian. [frame] */
#ifndef MAROTTE_PLUGINS_HANDS_MEMORY_H
#define MAROTTE_PLUGINS_HANDS_MEMORY_H
#include <marotte/plugin.h>

#include <float.h>

typedef enum memory_kind {
    MEMORY_BOOL = 0, /* bool */
    MEMORY_WHOLE,    /* int, unsigned or an enum: 0 to `most` */
    MEMORY_FLOAT,    /* float, -most to most */
    MEMORY_DOUBLE    /* double, -most to most */
} memory_kind;

typedef struct memory_part {
    memory_kind kind;
    void *at; /* NULL: the list is over */
    size_t size;
    double most;
} memory_part;

/* A variable, an array or a struct of nothing else (mrt_vec3: three floats); numbers: finite. */
/* clang-format off */
#define MEMORY_BOOLS(variable)        {MEMORY_BOOL, &(variable), sizeof(variable), 1.0}
#define MEMORY_WHOLES(variable, most) {MEMORY_WHOLE, &(variable), sizeof(variable), (double)(most)}
#define MEMORY_FLOATS(variable)       {MEMORY_FLOAT, &(variable), sizeof(variable), (double)FLT_MAX}
#define MEMORY_DOUBLES(variable)      {MEMORY_DOUBLE, &(variable), sizeof(variable), DBL_MAX}
/* clang-format on */

enum { MEMORY_PARTS_MAX = 64 };
typedef struct memory_list {
    const char *type; /* the plugin's id */
    uint32_t version; /* of the list */
    memory_part parts[MEMORY_PARTS_MAX];
} memory_list;

/* out may be NULL: the size it takes. Writes nothing when capacity is less. 0: a variable holds
 * what it may not, such as a number that is none. */
size_t memory_save(const memory_list *list, void *out, size_t capacity);
/* False: not bytes of such a list, or a value that it may not hold; nothing is changed. */
bool memory_load(const memory_list *list, const void *bytes, size_t size);

/* MRT_RESUME of a mapping, called `resume`: `list_of(self)` names all that it remembers. */
#define MEMORY_RESUME(list_of)                                                                     \
    static size_t resume_save(mrt_plugin *self, void *out, size_t capacity)                        \
    {                                                                                              \
        const memory_list list = list_of(self);                                                    \
        return memory_save(&list, out, capacity);                                                  \
    }                                                                                              \
    static mrt_result resume_load(mrt_plugin *self, const void *bytes, size_t size)                \
    {                                                                                              \
        const memory_list list = list_of(self);                                                    \
        return memory_load(&list, bytes, size) ? MRT_OK : MRT_ERR_FORMAT;                          \
    }                                                                                              \
    static const mrt_resume resume = {resume_save, resume_load}

#endif
