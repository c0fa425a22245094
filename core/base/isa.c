#include "base/isa.h"

#include <stdlib.h>
#include <string.h>

static const char *const names[ISA_COUNT] = {"generic", "v2", "v3", "v4"};

const char *isa_name(isa which)
{
    return (unsigned)which < ISA_COUNT ? names[which] : "?";
}

#if defined(__x86_64__)
static bool has_v2(void)
{
    return __builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("ssse3") &&
           __builtin_cpu_supports("popcnt");
}

static bool has_v3(void)
{
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
           __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
}

static bool has_v4(void)
{
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl");
}

bool isa_is_here(isa which)
{
    switch (which) {
    case ISA_GENERIC:
        return true;
    case ISA_V2:
        return has_v2();
    case ISA_V3:
        return has_v2() && has_v3();
    case ISA_V4:
        return has_v2() && has_v3() && has_v4();
    case ISA_COUNT:
        break;
    }
    return false;
}
#else
bool isa_is_here(isa which)
{
    return which == ISA_GENERIC;
}
#endif

isa isa_best(void)
{
    isa best = ISA_V4;
    while (best > ISA_GENERIC && !isa_is_here(best))
        --best;
    return best;
}

mrt_result isa_choose(isa *out, const char *word, error *err)
{
    *out = isa_best();
    if (!word || word[0] == '\0')
        return MRT_OK;
    for (int i = 0; i < ISA_COUNT; ++i)
        if (strcmp(word, names[i]) == 0) {
            if (!isa_is_here((isa)i))
                return error_set(err, MRT_ERR_UNSUPPORTED,
                                 "MAROTTE_ISA=%s: this machine has at most %s. Unset it to use "
                                 "that",
                                 word, isa_name(*out));
            *out = (isa)i;
            return MRT_OK;
        }
    return error_set(err, MRT_ERR_ARGUMENT,
                     "MAROTTE_ISA=%.40s is unknown: expected generic, v2, v3 or v4, or unset "
                     "for the best of this machine (%s)",
                     word, isa_name(*out));
}

isa isa_now(void)
{
    isa which;
    return isa_choose(&which, getenv("MAROTTE_ISA"), NULL) < 0 ? isa_best() : which;
}

mrt_result isa_check(error *err)
{
    isa which;
    return isa_choose(&which, getenv("MAROTTE_ISA"), err);
}
