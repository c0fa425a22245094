/* How the surface is solved: kept with the show, so that it performs tomorrow as it did today. */
#include "window/studio_state.h"

#include "stage/take/kept_solver.h"

void studio_solver_read(studio *self)
{
    kept_solver kept;
    error err = {0};
    if (kept_solver_read(&kept, self->show, &err) < 0)
        studio_say(self, MRT_LOG_WARNING, "%s", err.text);
    self->has_solver = kept.is_kept;
    self->solver = kept.as;
}

static mrt_result keep(studio *self, error *err)
{
    const kept_solver kept = {self->has_solver, self->solver};
    if (!self->show || !show_is_writable(self->show))
        return MRT_OK;
    return kept_solver_write(self->show, &kept, err);
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
