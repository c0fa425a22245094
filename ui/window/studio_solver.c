/* How the surface is solved: kept with the show, so that it performs tomorrow as it did today. */
#include "window/studio_state.h"

#include "base/text.h"

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

/* "wendland_c4 none 60" */
static bool read_solver(const char *text, csrbf_settings *out)
{
    char kernel[32], polynomial[32];
    text_view rest = text_view_of(text, strlen(text)), radius;
    *out = (csrbf_settings){0};
    return read_word(&rest, kernel, sizeof kernel) && csrbf_kernel_named(kernel, &out->kernel) &&
           read_word(&rest, polynomial, sizeof polynomial) &&
           csrbf_polynomial_named(polynomial, &out->polynomial) && text_next_word(&rest, &radius) &&
           text_double(radius, &out->radius) && out->radius >= 0.0;
}

void studio_solver_read(studio *self)
{
    char text[NOTE] = "";
    error err = {0};
    self->has_solver = false;
    if (!self->show)
        return;
    (void)studio_said(self, show_note_read(self->show, key, text, sizeof text, &err), &err);
    if (!text[0])
        return;
    self->has_solver = read_solver(text, &self->solver);
    if (!self->has_solver)
        studio_say(self, MRT_LOG_WARNING,
                   "%s: how it is solved, \"%s\", is not known here: as the rig says",
                   show_path(self->show), text);
}

static mrt_result keep(studio *self, error *err)
{
    char text[NOTE] = "";
    if (!self->show || !show_is_writable(self->show))
        return MRT_OK;
    if (self->has_solver)
        (void)snprintf(text, sizeof text, "%s %s %.9g", csrbf_kernel_name(self->solver.kernel),
                       csrbf_polynomial_name(self->solver.polynomial), self->solver.radius);
    return show_note_write(self->show, key, text, err);
}

const csrbf_settings *studio_solver(const studio *self)
{
    return self->has_solver ? &self->solver : NULL;
}

mrt_result studio_set_solver(studio *self, const csrbf_settings *solver, error *err)
{
    mrt_result result = live_set_solver(self->live, solver, err);
    if (result < 0)
        return result;
    self->has_solver = solver != NULL;
    if (solver)
        self->solver = *solver;
    return keep(self, err);
}
