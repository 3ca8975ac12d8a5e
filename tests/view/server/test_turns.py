"""Turns: one at a time, first come, first served."""

import threading
import time

from splatline.view.server.turns import Turns


def test_turns_are_given_in_order_and_one_at_a_time():
    turns, order, inside = Turns(), [], []

    def work(number):
        with turns.turn():
            inside.append(1)
            assert sum(inside) == 1
            order.append(number)
            time.sleep(0.002)
            inside.pop()

    threads = [threading.Thread(target=work, args=(number,)) for number in range(8)]
    with turns.turn():
        for number, thread in enumerate(threads):
            thread.start()
            while len(turns._waiting) <= number:
                time.sleep(0.001)
    for thread in threads:
        thread.join()
    assert order == list(range(8))


def test_long_work_lets_others_in():
    turns, log, going = Turns(), [], threading.Event()

    def long():
        with turns.turn():
            going.set()
            for step in range(200):
                log.append("long")
                time.sleep(0.001)
                turns.pass_on()
                if "short" in log and step > 2:
                    break
            log.append("end")

    thread = threading.Thread(target=long)
    thread.start()
    going.wait()
    with turns.turn():
        log.append("short")
    thread.join()
    assert log[-1] == "end"
    assert log.count("short") == 1


def test_a_turn_ends_with_an_exception():
    turns = Turns()
    for _ in range(2):
        try:
            with turns.turn():
                raise ValueError
        except ValueError:
            pass
    turns.pass_on()
    with turns.turn():
        turns.pass_on()
