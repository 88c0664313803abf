// Loops over arrays, compiled twice where the processor may have wider registers.
#pragma once

// Neither version fuses multiplications with additions, so both give the same bits. Which one is decided
// before the sanitizers have begun, where they would crash.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define SFUMATO_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define SFUMATO_WIDE
#endif
