/* Mesa's software renderer (llvmpipe; 22.3.6, and main when this was written) frees the fence of a
 * scene as soon as its count is full, while the thread that has counted last may not yet have let
 * go of the lock in it: four bytes of freed memory become 0, and some time later the allocator
 * falls over it. Every thread takes part in every scene, in order: so when a later scene is done,
 * nobody is in an earlier fence any more. Until then a fence is kept here.
 * tests/window/late_fence.sh */
#include "draw/gl.h"

#include <string.h>

enum { KEPT = 16 }; /* one frame or two: so far drawing may lag behind */

typedef struct kept_scenes { /* of the context of this thread */
    GLsync fence[KEPT];
    uint32_t first, count;
    bool is_known, is_llvmpipe;
} kept_scenes;

static _Thread_local kept_scenes kept;

static bool is_llvmpipe(void)
{
    if (!kept.is_known) {
        const char *renderer = (const char *)glGetString(GL_RENDERER);
        kept.is_llvmpipe = renderer && strstr(renderer, "llvmpipe");
        kept.is_known = true;
    }
    return kept.is_llvmpipe;
}

static void drop_first(void)
{
    glDeleteSync(kept.fence[kept.first]);
    kept.first = (kept.first + 1) % KEPT;
    kept.count -= 1;
}

void gl_end_scene(void)
{
    if (!is_llvmpipe())
        return;
    if (kept.count == KEPT) {
        (void)glClientWaitSync(kept.fence[(kept.first + 1) % KEPT], 0, GL_TIMEOUT_IGNORED);
        drop_first();
    }
    const GLsync fence = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    if (!fence)
        return;
    kept.fence[(kept.first + kept.count) % KEPT] = fence;
    kept.count += 1;
}

void gl_bind_framebuffer(GLenum target, GLuint framebuffer)
{
    if (target != GL_READ_FRAMEBUFFER && is_llvmpipe()) {
        GLint before = 0;
        glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &before);
        if ((GLuint)before != framebuffer)
            gl_end_scene();
    }
    glBindFramebuffer(target, framebuffer);
}

void gl_forget_scenes(void)
{
    if (kept.count > 0)
        glFinish();
    while (kept.count > 0)
        drop_first();
    kept = (kept_scenes){0};
}
