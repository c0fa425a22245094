#include "stage/playback/kept_solver.h"

#include "base/text.h"
#include "stage/perform/composer.h"

#include <stdio.h>
#include <string.h>

static const char key[] = "solver";
enum { NOTE = 160 };

static bool read_word(text_view *rest, char *out, size_t capacity)
{
    text_view word;
    if (!text_next_word(rest, &word))
        return false;
    text_copy(out, capacity, word);
    return true;
}

/* Parses a text such as "wendland_c4 none 60". */
static bool parse(csrbf_settings *out, const char *text)
{
    char kernel[32], polynomial[32];
    text_view rest = text_view_of(text, strlen(text)), radius;
    *out = (csrbf_settings){0};
    return read_word(&rest, kernel, sizeof kernel) && csrbf_kernel_named(kernel, &out->kernel) &&
           read_word(&rest, polynomial, sizeof polynomial) &&
           csrbf_polynomial_named(polynomial, &out->polynomial) && text_next_word(&rest, &radius) &&
           text_double(radius, &out->radius) && out->radius >= 0.0;
}

mrt_result kept_solver_read(kept_solver *out, show *of, error *err)
{
    char text[NOTE] = "";
    *out = (kept_solver){.is_kept = false};
    mrt_result result = of ? show_note_read(of, key, text, sizeof text, err) : MRT_OK;
    if (result < 0 || !text[0])
        return result;
    out->is_kept = parse(&out->as, text);
    return out->is_kept ? MRT_OK
                        : error_set(err, MRT_ERR_FORMAT,
                                    "%s: the solver \"%s\" is unknown. The rig's solver is used.",
                                    show_path(of), text);
}

mrt_result kept_solver_write(show *into, const kept_solver *kept, error *err)
{
    char text[NOTE] = "";
    if (kept->is_kept)
        (void)snprintf(text, sizeof text, "%s %s %.9g", csrbf_kernel_name(kept->as.kernel),
                       csrbf_polynomial_name(kept->as.polynomial), kept->as.radius);
    return show_note_write(into, key, text, err);
}

csrbf_settings kept_solver_on(const kept_solver *kept, const face_file *file)
{
    csrbf_settings out = {.radius = 0.0};
    if (!kept->is_kept)
        return out;
    out = kept->as;
    if (!(out.radius > 0.0))
        out.radius = composer_radius_of(file);
    return out;
}

csrbf_settings kept_solver_for(show *of, const face_file *file, log_queue *log)
{
    kept_solver kept;
    error err = {""};
    if (kept_solver_read(&kept, of, &err) < 0)
        log_push(log, MRT_LOG_WARNING, "show", err.text);
    return kept_solver_on(&kept, file);
}
