/* template/template_files.h - the files that `marotte plugin new` writes: the files of this folder,
 * embedded in the program. In each, "template_name" stands for the plugin's name. */
#ifndef MAROTTE_TEMPLATE_FILES_H
#define MAROTTE_TEMPLATE_FILES_H
#include <stddef.h>

typedef struct template_file {
    const char *name; /* path in the plugin's folder */
    const char *bytes;
    size_t size;
} template_file;

enum { TEMPLATE_FILES = 4 };
extern const template_file template_mapping[TEMPLATE_FILES], template_input[TEMPLATE_FILES],
    template_output[TEMPLATE_FILES];

#endif
