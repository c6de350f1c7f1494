/* The table and the samples of the bench, from files in the folders of the assembler's -I. */
    .section .rodata
    .global bench_table, bench_table_end, bench_flight, bench_flight_end
    .balign 8
bench_table:
    .incbin "filter.bin"
bench_table_end:
    .balign 8
bench_flight:
    .incbin "flight.bin"
bench_flight_end:

/* Nothing here is run from the stack. */
    .section .note.GNU-stack, "", %progbits
