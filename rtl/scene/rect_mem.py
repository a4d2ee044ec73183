# SPDX-License-Identifier: MIT
"""The memory of the scene's rectangles."""

from myhdl import Signal, always, always_comb, always_seq, block, concat, instances, intbv

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, side_by_side, signed, tied, unsigned
from raycaster.hdl.verbs import assign, register
from raycaster.rtl.common.records import Rect
from raycaster.rtl.common.widths import WORD_BITS, index_bits
from raycaster.rtl.scene.rect_slot import rect_slot
from raycaster.rtl.scene.rect_sorter import rect_sorter
from raycaster.rtl.scene.written_rect import BANK_BITS, BANKS, CORNER, Copies, WrittenRect, implemented_bits


@block
def rect_mem(clk, reset, bus, readback, bad_rectangle, rects, config: Configuration):
    """Hold `config.rectangles` slots of rectangles, and present the live rectangle that the engine fetches.

    One memory holds the shadow as written, and is read in the cycle before a word is read or written, so block RAM
    will do. Another holds the rectangles in the engine's form, in three banks per slot: enough for the shadow, pending
    and live copy. A cycle after a write, the rectangle is sorted into a bank that holds neither the pending nor the
    live copy; a commit and StartScreen only reassign banks to copies. Reset clears neither memory: a slot that has not
    been written since reads 0, and is not usable.

    Args:
        bus: `SceneBus`; input.
        readback: unsigned, 32 bits; output, the shadow's word at bus.address, 0 if there is none. Valid in the cycle
            after bus.access.
        bad_rectangle: flag; output, the shadow holds an enabled rectangle without a plane. Valid from the second cycle
            after a write on.
        rects: `Rects`; reads index and fetch, drives usable and rect. rect is don't care if the rectangle is not
            usable.
    """
    count = config.rectangles
    table_slot = CORNER.address // 4
    address_width = len(bus.address)
    index_width = index_bits(config)

    slot = signed(address_width - 1)
    index, chosen = (Signal(intbv(0, min=0, max=count)) for _ in range(2))
    next_index = unsigned(index_width)
    found, in_table, known, write, repeats, again = (bit() for _ in range(6))
    written = unsigned(count)
    stored, old, mask, data, merged = (WrittenRect(config) for _ in range(5))
    implemented = tied(implemented_bits(config), len(merged.word))
    pattern_word = old.pattern if old.has("pattern") else tied(0, WORD_BITS)
    mask_0, mask_1, mask_2, mask_3 = (unsigned(WORD_BITS) for _ in range(4))
    shadow_words = [unsigned(len(merged.word)) for _ in range(1 << index_width)]

    numbers = [tied(number, index_width) for number in range(count)]
    usables, bads = ([bit() for _ in range(count)] for _ in range(2))
    usable, bad = side_by_side(usables), side_by_side(bads)
    storing, flat, reads = bit(), bit(), bit()
    latest_index = unsigned(index_width)
    latest = WrittenRect(config)
    all_copies = [Copies() for _ in range(count)]
    copies_words = [copies.word for copies in all_copies]
    latest_copies, read_copies = Copies(), Copies()
    bank = unsigned(BANK_BITS)
    kept_0, kept_1 = bit(), bit()

    sorted_rect = Rect(config)
    banks = [unsigned(len(sorted_rect.word)) for _ in range(BANKS << index_width)]
    write_address, read_address = (unsigned(BANK_BITS + index_width) for _ in range(2))

    slots = [
        rect_slot(
            clk, reset, bus, storing, latest_index, numbers[i], bank=bank, enable=latest.enable, flat=flat,
            copies=all_copies[i], usable=usables[i], bad=bads[i],
        )
        for i in range(count)
    ]  # fmt: skip
    sorter = rect_sorter(latest, sorted_rect)

    # The table starts after the other registers.
    locate = assign(slot, lambda: bus.next_address[address_width:2] - table_slot)
    find_next = assign(next_index, lambda: slot[index_width:])

    # Outside the table index is 0, so that it stays within the memories.
    clip_found = assign(found, lambda: (slot >= 0) and (slot < count))
    clip_chosen = assign(chosen, lambda: slot[index_width:] if (slot >= 0) and (slot < count) else 0)

    # All are those of bus.address, as this changes with an access only. A write never comes before the first access.
    follow_address = register(clk, (in_table, index), lambda: (found, chosen), bus.access)

    @always_seq(clk.posedge, reset=reset)
    def follow_written():
        if bus.access:
            known.next = written[chosen] or repeats

    decode = assign(write, lambda: bus.write and in_table)
    see_repetition = assign(repeats, lambda: write and next_index == index)

    # A word that is being written is not read, in either memory, as block RAM would need logic for that: the words of
    # such a slot are in the register behind the merger. Outside the table, words are don't care.
    @always(clk.posedge)
    def read_shadow():
        if bus.access:
            again.next = repeats
            if not repeats:
                stored.word.next = shadow_words[next_index]

    @always_comb
    def find_old():
        old.word.next = 0
        if known:
            old.word.next = stored.word
            if again:
                old.word.next = latest.word

    # 0 outside the table.
    @always_comb
    def read_word():
        readback.next = 0
        if in_table:
            if bus.address[2:] == 0:
                readback.next = old.corner_0
            elif bus.address[2:] == 1:
                readback.next = old.corner_1
            elif bus.address[2:] == 2:
                readback.next = old.surface
            else:
                readback.next = pattern_word

    select_0 = assign(mask_0, lambda: bus.mask if bus.address[2:] == 0 else 0)
    select_1 = assign(mask_1, lambda: bus.mask if bus.address[2:] == 1 else 0)
    select_2 = assign(mask_2, lambda: bus.mask if bus.address[2:] == 2 else 0)

    if mask.has("pattern"):
        select_pattern = assign(mask_3, lambda: bus.mask if bus.address[2:] == 3 else 0)

    whole_mask = mask.joined(corner_0=mask_0, corner_1=mask_1, surface=mask_2, pattern=mask_3)
    whole_data = data.joined(corner_0=bus.data, corner_1=bus.data, surface=bus.data, pattern=bus.data)

    spread = assign((mask.word, data.word), lambda: (whole_mask, whole_data))

    merge = assign(merged.word, lambda: ((old.word & ~mask.word) | (data.word & mask.word)) & implemented)
    store_shadow = register(clk, shadow_words[index], lambda: merged.word, write)

    @always_seq(clk.posedge, reset=reset)
    def remember_written():
        if write:
            written.next[index] = True

    # Merging and sorting take a cycle each. No commit comes too early, because the write that requests it takes a
    # cycle.
    hand_over = register(clk, (latest.word, latest_index), lambda: (merged.word, index))

    @always_seq(clk.posedge, reset=reset)
    def follow_write():
        storing.next = write

    # A rectangle lies in a plane if its corners share a coordinate.
    @always_comb
    def find_plane():
        flat.next = (latest.x_0 == latest.x_1) or (latest.y_0 == latest.y_1) or (latest.z_0 == latest.z_1)

    find_copies = assign(latest_copies.word, lambda: copies_words[latest_index])

    # StartScreen makes the pending bank live, so these two are enough. No commit comes while a rectangle is stored.
    find_kept_0 = assign(kept_0, lambda: (latest_copies.pending == 0) or (latest_copies.live == 0))
    find_kept_1 = assign(kept_1, lambda: (latest_copies.pending == 1) or (latest_copies.live == 1))

    @always_comb
    def choose_place():
        bank.next = 0
        if kept_0 and kept_1:
            bank.next = 2
        elif kept_0:
            bank.next = 1

    address = assign(
        (write_address, read_address), lambda: (concat(bank, latest_index), concat(read_copies.live, rects.index))
    )
    store_sorted = register(clk, banks[write_address], lambda: sorted_rect.word, storing)
    show_slots = assign((bad_rectangle, rects.usable), lambda: (bad != 0, usable))
    find_live = assign(read_copies.word, lambda: copies_words[rects.index])

    # No usable rectangle is in a bank that is being written.
    see_reading = assign(reads, lambda: rects.fetch and not (storing and write_address == read_address))

    present = register(clk, rects.rect.word, lambda: banks[read_address], reads)

    return instances()
